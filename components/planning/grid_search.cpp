#include "components/planning/grid_search.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace kervan::planning {
namespace {

constexpr unsigned bit_of(unsigned direction) { return 1u << (direction % 8); }

/// By the move that led into a cell, or `from_nowhere`, and the moves that the cell allows.
using MoveTable = std::array<std::uint8_t, 9 * 256>;

/// All but three: the cell before and what could be entered from there at least as well, whatever it weighs. Behind a
/// straight move these are the three cells behind it, behind a diagonal one the cells beside the way it came.
constexpr MoveTable make_onward_moves() {
  MoveTable table{};
  for (unsigned moves = 0; moves < 256; ++moves) {
    for (unsigned d = 0; d < 8; ++d)
      table[d * 256 + moves] = static_cast<std::uint8_t>(moves & ~(bit_of(d + 3) | bit_of(d + 4) | bit_of(d + 5)));
    table[8 * 256 + moves] = static_cast<std::uint8_t>(moves);
  }
  return table;
}

/// After a straight move the next cell ahead; to a side, and ahead of it, only if the cell behind that side is blocked:
/// else the way round is diagonal and shorter. After a diagonal move itself and its two straight parts.
constexpr MoveTable make_canonical_moves() {
  MoveTable table{};
  for (unsigned moves = 0; moves < 256; ++moves) {
    for (unsigned d = 0; d < 8; ++d) {
      unsigned look_at = bit_of(d);
      if (d % 2 == 1) look_at |= bit_of(d + 1) | bit_of(d + 7);
      if (d % 2 == 0 && (moves & bit_of(d + 3)) == 0) look_at |= bit_of(d + 2) | bit_of(d + 1);
      if (d % 2 == 0 && (moves & bit_of(d + 5)) == 0) look_at |= bit_of(d + 6) | bit_of(d + 7);
      table[d * 256 + moves] = static_cast<std::uint8_t>(look_at & moves);
    }
    table[8 * 256 + moves] = static_cast<std::uint8_t>(moves);
  }
  return table;
}

constexpr MoveTable onward_table = make_onward_moves();
constexpr MoveTable canonical_table = make_canonical_moves();

/// f of a neighbour is larger than its parent's by at most twice the move.
constexpr std::uint64_t widest_step = 2 * GridSearch::diagonal_cost * Costmap::heaviest;
constexpr unsigned step_buckets = 13;  // 2^13: a sixth of a straight move

}  // namespace

const std::uint8_t* canonical_moves() { return canonical_table.data(); }

std::uint64_t GridSearch::to_goal(std::uint32_t place) const {
  constexpr std::uint32_t straight = straight_cost * Costmap::lightest,
                          slanting = (diagonal_cost - straight_cost) * Costmap::lightest;
  static_assert((std::uint64_t{straight} + slanting) * Costmap::widest < (std::uint64_t{1} << 32));
  const auto dx = static_cast<std::uint32_t>(std::abs(static_cast<int>(place & 0xffffu) - goal_.x)),
             dy = static_cast<std::uint32_t>(std::abs(static_cast<int>(place >> 16) - goal_.y));
  return straight * std::max(dx, dy) + slanting * std::min(dx, dy);
}

void GridSearch::begin(const Costmap& map, SearchRule rule) {
  if (labels_.size() != map.cells() || age_ == 0) {
    labels_.assign(map.cells(), ~Label{0});
    age_ = age_bits;
    open_.reserve(map.cells());
    path_.reserve(static_cast<std::size_t>(4 * (map.columns() + map.rows())));
  }
  age_ -= Label{1} << age_shift;
  if (rule == SearchRule::jump_point && parents_.size() != map.cells()) parents_.assign(map.cells(), 0);
}

Reached GridSearch::find(const Costmap& map, Cell start, Cell goal, SearchRule rule, std::size_t most_expanded) {
  start_ = start;
  goal_ = goal;
  goal_cost_ = unknown_cost;
  expanded_ = 0;
  cost_ = 0.0;
  path_.clear();
  begin(map, rule);
  if (rule == SearchRule::jump_point) return jump(map, most_expanded);
  return rule == SearchRule::canonical ? walk<true>(map, most_expanded) : walk<false>(map, most_expanded);
}

template <bool canonical>
Reached GridSearch::walk(const Costmap& map, std::size_t most_expanded) {
  const std::uint16_t* const infos = map.infos();
  const std::uint32_t goal = map.index(goal_.x, goal_.y), first = map.index(start_.x, start_.y);
  std::array<std::uint32_t, directions> offsets, steps;
  for (unsigned d = 0; d < directions; ++d) {
    offsets[d] = static_cast<std::uint32_t>(step_x[d] + step_y[d] * static_cast<int>(map.stride()));
    steps[d] = BucketQueue::place_of(step_x[d], step_y[d]);
  }
  constexpr std::array<std::uint64_t, 2> costs = {straight_cost, diagonal_cost};

  labels_[first] = label(0, from_nowhere);
  const std::uint32_t place = BucketQueue::place_of(start_.x, start_.y);
  const std::uint64_t f = to_goal(place);
  open_.begin(f, step_buckets, widest_step);
  open_.push(f, first, 0, place);
  BucketQueue::Entry entry, in_hand{};
  bool held = false;
  while (held || open_.pop(entry, goal_cost_)) {
    if (held) entry = in_hand;
    held = false;
    const Label here = labels_[entry.cell];
    const std::uint64_t g = cost_of(here);
    if (static_cast<std::uint32_t>(g) != entry.g) continue;  // a cheaper way was found after it had been queued
    if (entry.cell == goal) {
      goal_cost_ = g;
      continue;
    }
    if (goal_cost_ != unknown_cost && g + to_goal(entry.place) >= goal_cost_) continue;
    if (++expanded_ > most_expanded && most_expanded != 0) return Reached::gave_up;
    const unsigned info = infos[entry.cell];
    const MoveTable& table = canonical && (info & Costmap::flat) != 0 ? canonical_table : onward_table;
    unsigned moves = table[direction_of(here) * 256 + (info & 0xffu)];
    for (; moves != 0; moves &= moves - 1) {
      const auto d = static_cast<unsigned>(std::countr_zero(moves));
      const std::uint32_t next = entry.cell + offsets[d];
      const std::uint64_t cost = g + costs[d & 1u] * (infos[next] >> Costmap::weight_shift);
      const Label better = label(cost, d);
      if ((better | direction_bits) >= labels_[next]) continue;
      labels_[next] = better;
      const std::uint32_t place_there = entry.place + steps[d];
      const std::uint64_t f_there = cost + to_goal(place_there);
      if (!held && open_.next_out(f_there)) {
        in_hand = {next, static_cast<std::uint32_t>(cost), place_there, 0};
        held = true;
      } else {
        open_.push(f_there, next, cost, place_there);
      }
    }
  }
  if (goal_cost_ == unknown_cost) return Reached::no_path;
  cost_ = static_cast<double>(goal_cost_) / static_cast<double>(straight_cost * Costmap::lightest);
  trace_steps(map);
  return Reached::goal;
}

void GridSearch::trace_steps(const Costmap& map) {
  for (Cell at = goal_;;) {
    path_.push_back(at);
    const unsigned d = direction_of(labels_[map.index(at.x, at.y)]);
    if (d == from_nowhere) break;
    at = {at.x - step_x[d], at.y - step_y[d]};
  }
  std::reverse(path_.begin(), path_.end());
}

}  // namespace kervan::planning
