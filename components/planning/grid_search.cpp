#include "components/planning/grid_search.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

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

/// S max(dx, dy) + (D - S) min(dx, dy), written as D/2 (dx + dy) + (S - D/2) |dx - dy|: nothing in it has to be
/// guessed.
std::uint64_t GridSearch::to_goal(std::uint32_t place) const {
  constexpr std::uint64_t both = diagonal_cost * Costmap::lightest / 2,
                          apart = straight_cost * Costmap::lightest - both;
  const int dx = std::abs(static_cast<int>(place & 0xffffu) - goal_.x),
            dy = std::abs(static_cast<int>(place >> 16) - goal_.y);
  return both * static_cast<std::uint32_t>(dx + dy) + apart * static_cast<std::uint32_t>(std::abs(dx - dy));
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

/// A*. A neighbour that would be the next one out of the queue is kept in hand instead, so that a way straight on is
/// followed without it.
template <bool canonical>
class GridSearch::Walk {
 public:
  Walk(GridSearch& search, const Costmap& map)
      : search_(search),
        infos_(map.infos()),
        labels_(search.labels_.data()),
        stride_(map.stride()),
        goal_(map.index(search.goal_.x, search.goal_.y)),
        open_(std::move(search.open_)) {
    for (unsigned d = 0; d < directions; ++d) {
      offsets_[d] = static_cast<std::uint32_t>(step_x[d] + step_y[d] * static_cast<int>(map.stride()));
      places_[d] = BucketQueue::place_of(step_x[d], step_y[d]);
    }
  }
  ~Walk() { search_.open_ = std::move(open_); }

  Walk(const Walk&) = delete;
  Walk& operator=(const Walk&) = delete;

  Reached from(std::uint32_t first, std::uint32_t place, std::size_t most_expanded) {
    const std::uint64_t f = search_.to_goal(place);
    labels_[first] = search_.label(0, from_nowhere);
    open_.begin(f, step_buckets, widest_step);
    open_.push(f, first, 0, place);
    BucketQueue::Entry entry;
    while (open_.pop(entry, goal_cost_)) {
      const Label here = labels_[entry.cell];
      const std::uint64_t g = cost_of(here);
      if (static_cast<std::uint32_t>(g) != entry.g) continue;  // a cheaper way was found after it had been queued
      now_ = {entry.cell, entry.place, g, direction_of(here)};
      do {
        if (now_.cell == goal_) {
          goal_cost_ = now_.g;
          break;
        }
        if (goal_cost_ != unknown_cost && now_.g + search_.to_goal(now_.place) >= goal_cost_) break;
        if (++search_.expanded_ > most_expanded && most_expanded != 0) return Reached::gave_up;
      } while (expand());
    }
    search_.goal_cost_ = goal_cost_;
    return goal_cost_ == unknown_cost ? Reached::no_path : Reached::goal;
  }

 private:
  struct Visit {
    std::uint32_t cell, place;
    std::uint64_t g;
    unsigned direction;
  };

  /// True if one of the neighbours is in hand now.
  bool expand() {
    const unsigned info = infos_[now_.cell], allowed = info & 0xffu;
    const Visit here = now_;
    if ((info & Costmap::flat) == 0) return look_at_all(here, onward_table[here.direction * 256 + allowed]);
    const unsigned weight = info >> Costmap::weight_shift;
    const std::array<std::uint64_t, 2> costs = {here.g + straight_cost * weight, here.g + diagonal_cost * weight};
    if constexpr (!canonical) return enter_better(here, allowed, costs);
    const unsigned moves = canonical_table[here.direction * 256 + allowed];
    if (moves == 1u << here.direction) return look_at(here, here.direction, costs[here.direction & 1u], false);
    bool held = false;
    for (unsigned left = moves; left != 0; left &= left - 1) {
      const auto d = static_cast<unsigned>(std::countr_zero(left));
      held = look_at(here, d, costs[d & 1u], held) || held;
    }
    return held;
  }

  bool look_at_all(const Visit& here, unsigned moves) {
    constexpr std::array<std::uint64_t, 2> costs = {straight_cost, diagonal_cost};
    bool held = false;
    for (; moves != 0; moves &= moves - 1) {
      const auto d = static_cast<unsigned>(std::countr_zero(moves));
      const unsigned weight = infos_[here.cell + offsets_[d]] >> Costmap::weight_shift;
      held = look_at(here, d, here.g + costs[d & 1u] * weight, held) || held;
    }
    return held;
  }

  /// All eight labels are compared before anything depends on one of them.
  bool enter_better(const Visit& here, unsigned moves, const std::array<std::uint64_t, 2>& costs) {
    const Label straight = search_.label(costs[0], 0) | direction_bits,
                slanting = search_.label(costs[1], 0) | direction_bits;
    const Label *const row = labels_ + here.cell, *const up = row + stride_, *const down = row - stride_;
    const unsigned better = unsigned{straight < row[1]} | unsigned{slanting < up[1]} << 1 |
                            unsigned{straight < up[0]} << 2 | unsigned{slanting < up[-1]} << 3 |
                            unsigned{straight < row[-1]} << 4 | unsigned{slanting < down[-1]} << 5 |
                            unsigned{straight < down[0]} << 6 | unsigned{slanting < down[1]} << 7;
    bool held = false;
    for (unsigned left = moves & better; left != 0; left &= left - 1) {
      const auto d = static_cast<unsigned>(std::countr_zero(left));
      held = enter(here, d, costs[d & 1u], held) || held;
    }
    return held;
  }

  bool look_at(const Visit& here, unsigned d, std::uint64_t cost, bool held) {
    if ((search_.label(cost, d) | direction_bits) >= labels_[here.cell + offsets_[d]]) return false;
    return enter(here, d, cost, held);
  }

  /// True if the cell is in hand now, which needs it to be empty: not `held`.
  bool enter(const Visit& here, unsigned d, std::uint64_t cost, bool held) {
    const std::uint32_t cell = here.cell + offsets_[d], place = here.place + places_[d];
    labels_[cell] = search_.label(cost, d);
    const std::uint64_t f = cost + search_.to_goal(place);
    if (!held && open_.next_out(f)) {
      now_ = {cell, place, cost, d};
      return true;
    }
    open_.push(f, cell, cost, place);
    return false;
  }

  GridSearch& search_;
  const std::uint16_t* infos_;
  Label* labels_;
  std::ptrdiff_t stride_;
  std::uint32_t goal_;
  std::array<std::uint32_t, directions> offsets_, places_;
  BucketQueue open_;
  std::uint64_t goal_cost_ = unknown_cost;
  Visit now_{};
};

template <bool canonical>
Reached GridSearch::walk(const Costmap& map, std::size_t most_expanded) {
  const Reached reached =
      Walk<canonical>(*this, map)
          .from(map.index(start_.x, start_.y), BucketQueue::place_of(start_.x, start_.y), most_expanded);
  if (reached != Reached::goal) return reached;
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
