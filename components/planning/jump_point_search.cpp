// The jumps of GridSearch: a line of cells is looked at as bits, up to where it ends or somebody has to turn.
#include <algorithm>
#include <bit>
#include <cmath>

#include "components/planning/grid_search.hpp"

namespace kervan::planning {
namespace {

constexpr std::uint64_t straight = GridSearch::straight_cost * Costmap::lightest;
constexpr std::uint64_t diagonal = GridSearch::diagonal_cost * Costmap::lightest;
constexpr unsigned jump_buckets = 15;

constexpr int at_once = BlockedBits::window - 1;
constexpr std::uint64_t these = (std::uint64_t{1} << at_once) - 1;

/// Where a way along a line stops: at the first cell behind a corner, where it may turn round it, or before the first
/// blocked one. Never looks back at `at` itself.
struct Stop {
  int at;
  bool blocked;  ///< there is nothing at `at` but the end of the way
};

/// Along the line's cells behind `at`.
Stop stop_ahead(const BlockedBits& bits, int line, int at) {
  for (int first = at + 1;; first += at_once) {
    const std::uint64_t ahead = bits.bits_from(line, first);
    const std::uint64_t left = bits.bits_from(line + 1, first - 1), right = bits.bits_from(line - 1, first - 1);
    const std::uint64_t corners = (left & ~(left >> 1)) | (right & ~(right >> 1));
    const std::uint64_t stops = (ahead | corners) & these;
    if (stops == 0) continue;
    const int bit = std::countr_zero(stops);
    return {first + bit, (ahead >> bit & 1u) != 0};
  }
}

/// Along the line's cells before `at`.
Stop stop_behind(const BlockedBits& bits, int line, int at) {
  for (int first = at - at_once;; first -= at_once) {
    const std::uint64_t ahead = bits.bits_from(line, first);
    const std::uint64_t left = bits.bits_from(line + 1, first), right = bits.bits_from(line - 1, first);
    const std::uint64_t corners = (~left & (left >> 1)) | (~right & (right >> 1));
    const std::uint64_t stops = (ahead | corners) & these;
    if (stops == 0) continue;
    const int bit = 63 - std::countl_zero(stops);
    return {first + bit, (ahead >> bit & 1u) != 0};
  }
}

}  // namespace

void GridSearch::reach(std::uint32_t parent, std::uint32_t cell, int x, int y, std::uint64_t cost, unsigned direction) {
  const Label better = label(cost, direction);
  if ((better | direction_bits) >= labels_[cell]) return;
  labels_[cell] = better;
  parents_[cell] = parent;
  const std::uint32_t place = BucketQueue::place_of(x, y);
  open_.push(cost + to_goal(place), cell, cost, place);
}

/// From (x, y), which was reached from `from` at `cost`, on in a straight line: to the goal, or to where it stops.
void GridSearch::jump_straight(const Costmap& map, const BucketQueue::Entry& from, unsigned direction,
                               std::uint64_t cost, int x, int y) {
  const bool along_row = direction % 4 == 0, ahead = direction < 4;
  const BlockedBits& bits = along_row ? map.row_bits() : map.column_bits();
  const int line = along_row ? y : x, at = along_row ? x : y;
  const int goal_line = along_row ? goal_.y : goal_.x, goal_at = along_row ? goal_.x : goal_.y;
  const Stop stop = ahead ? stop_ahead(bits, line, at) : stop_behind(bits, line, at);
  int to = stop.at;
  if (line == goal_line && (ahead ? goal_at > at && goal_at <= to : goal_at < at && goal_at >= to))
    to = goal_at;
  else if (stop.blocked)
    return;
  const int to_x = along_row ? to : x, to_y = along_row ? y : to;
  reach(from.cell, map.index(to_x, to_y), to_x, to_y, cost + straight * static_cast<std::uint64_t>(std::abs(to - at)),
        direction);
}

/// A way turns off a diagonal only into one of its straight parts: where it does is no jump point of its own.
void GridSearch::jump_diagonally(const Costmap& map, const BucketQueue::Entry& from, unsigned direction,
                                 std::uint64_t cost) {
  int x = from.x(), y = from.y();
  std::uint32_t cell = from.cell;
  const auto offset =
      static_cast<std::uint32_t>(step_x[direction] + step_y[direction] * static_cast<int>(map.stride()));
  const std::uint32_t goal = map.index(goal_.x, goal_.y);
  while ((map.infos()[cell] >> direction & 1u) != 0) {
    x += step_x[direction];
    y += step_y[direction];
    cell += offset;
    cost += diagonal;
    if (cell == goal) return reach(from.cell, cell, x, y, cost, direction);
    jump_straight(map, from, direction - 1, cost, x, y);
    jump_straight(map, from, (direction + 1) % 8, cost, x, y);
  }
}

/// True if nothing is on the way that is diagonal first: none is shorter, and there is nothing to search.
bool GridSearch::lies_open(const Costmap& map) {
  Cell at = start_;
  std::uint32_t cell = map.index(at.x, at.y);
  const unsigned d = goal_.y > at.y ? (goal_.x > at.x ? 1 : 3) : (goal_.x > at.x ? 7 : 5);
  const auto offset = static_cast<std::uint32_t>(step_x[d] + step_y[d] * static_cast<int>(map.stride()));
  for (; at.x != goal_.x && at.y != goal_.y; at = {at.x + step_x[d], at.y + step_y[d]}, cell += offset)
    if ((map.infos()[cell] >> d & 1u) == 0) return false;
  const bool along_row = at.y == goal_.y;
  const BlockedBits& bits = along_row ? map.row_bits() : map.column_bits();
  const int line = along_row ? at.y : at.x;
  const auto [begin, last] = along_row ? std::minmax(at.x, goal_.x) : std::minmax(at.y, goal_.y);
  for (int first = begin; first <= last; first += at_once) {
    const std::uint64_t asked = these >> (at_once - std::min(at_once, last - first + 1));
    if ((bits.bits_from(line, first) & asked) != 0) return false;
  }
  return true;
}

Reached GridSearch::jump(const Costmap& map, std::size_t most_expanded) {
  const std::uint32_t goal = map.index(goal_.x, goal_.y), first = map.index(start_.x, start_.y);
  labels_[first] = label(0, from_nowhere);
  parents_[first] = first;
  const std::uint32_t place = BucketQueue::place_of(start_.x, start_.y);
  const std::uint64_t f = to_goal(place);
  if (lies_open(map)) {
    parents_[goal] = first;
    expanded_ = 1;
    cost_ = static_cast<double>(f) / static_cast<double>(straight);
    trace_jumps(map);
    return Reached::goal;
  }
  // A jump is a diagonal and a straight line; f grows by at most twice its cost.
  open_.begin(f, jump_buckets, 2 * diagonal * static_cast<std::uint64_t>(map.columns() + map.rows()));
  open_.push(f, first, 0, place);
  const std::uint8_t* const table = canonical_moves();
  BucketQueue::Entry entry;
  while (open_.pop(entry, goal_cost_)) {
    const Label here = labels_[entry.cell];
    const std::uint64_t g = cost_of(here);
    if (static_cast<std::uint32_t>(g) != entry.g) continue;
    if (entry.cell == goal) {
      goal_cost_ = g;
      continue;
    }
    if (goal_cost_ != unknown_cost && g + to_goal(entry.place) >= goal_cost_) continue;
    if (++expanded_ > most_expanded && most_expanded != 0) return Reached::gave_up;
    unsigned moves = table[direction_of(here) * 256 + (map.infos()[entry.cell] & 0xffu)];
    for (; moves != 0; moves &= moves - 1) {
      const auto d = static_cast<unsigned>(std::countr_zero(moves));
      if (d % 2 == 0)
        jump_straight(map, entry, d, g, entry.x(), entry.y());
      else
        jump_diagonally(map, entry, d, g);
    }
  }
  if (goal_cost_ == unknown_cost) return Reached::no_path;
  cost_ = static_cast<double>(goal_cost_) / static_cast<double>(straight);
  trace_jumps(map);
  return Reached::goal;
}

void GridSearch::trace_jumps(const Costmap& map) {
  Cell at = goal_;
  std::uint32_t cell = map.index(at.x, at.y);
  path_.push_back(at);
  while (parents_[cell] != cell) {
    cell = parents_[cell];
    const Cell parent{static_cast<int>(cell % map.stride()), static_cast<int>(cell / map.stride())};
    // The way from the parent was diagonal first, so back it is straight first.
    while (at != parent) {
      const int dx = parent.x - at.x, dy = parent.y - at.y;
      const int far = std::max(std::abs(dx), std::abs(dy)), near = std::min(std::abs(dx), std::abs(dy));
      const bool slanting = far == near;
      if (slanting || std::abs(dx) > std::abs(dy)) at.x += dx > 0 ? 1 : -1;
      if (slanting || std::abs(dy) > std::abs(dx)) at.y += dy > 0 ? 1 : -1;
      path_.push_back(at);
    }
  }
  std::reverse(path_.begin(), path_.end());
}

}  // namespace kervan::planning
