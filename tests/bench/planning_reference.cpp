#include "tests/bench/planning_reference.hpp"

#include <algorithm>
#include <cmath>

#include "components/planning/string_pulling.hpp"

namespace kervan::bench {

using planning::Costmap;
using planning::GridSearch;

std::optional<double> TextbookSearch::find(const Costmap& map, Cell start, Cell goal) {
  if (nodes_.size() != map.cells()) nodes_.assign(map.cells(), Node{0, 0, 0, false});
  ++age_;
  expanded_ = 0;
  open_.clear();
  const auto push = [&](std::uint32_t cell, int x, int y, std::uint64_t g) {
    const auto dx = static_cast<std::uint64_t>(std::abs(x - goal.x)),
               dy = static_cast<std::uint64_t>(std::abs(y - goal.y));
    const std::uint64_t h =
        Costmap::lightest * (GridSearch::straight_cost * std::max(dx, dy) +
                             (GridSearch::diagonal_cost - GridSearch::straight_cost) * std::min(dx, dy));
    open_.push_back({g + h, cell});
    std::push_heap(open_.begin(), open_.end());
  };
  const std::uint32_t first = map.index(start.x, start.y), last = map.index(goal.x, goal.y);
  nodes_[first] = {0, age_, 8, false};
  push(first, start.x, start.y, 0);
  while (!open_.empty()) {
    const std::uint32_t cell = open_.front().cell;
    std::pop_heap(open_.begin(), open_.end());
    open_.pop_back();
    Node& here = nodes_[cell];
    if (here.closed) continue;
    here.closed = true;
    ++expanded_;
    if (cell == last)
      return static_cast<double>(here.g) / static_cast<double>(GridSearch::straight_cost * Costmap::lightest);
    const int x = static_cast<int>(cell % map.stride()), y = static_cast<int>(cell / map.stride());
    for (unsigned d = 0; d < planning::directions; ++d) {
      if ((map.infos()[cell] >> d & 1u) == 0) continue;
      const int to_x = x + planning::step_x[d], to_y = y + planning::step_y[d];
      const std::uint32_t next = map.index(to_x, to_y);
      const std::uint64_t step = d % 2 == 0 ? GridSearch::straight_cost : GridSearch::diagonal_cost;
      const std::uint64_t g = here.g + step * map.weight(next);
      Node& there = nodes_[next];
      if (there.age == age_ && there.g <= g) continue;
      there = {g, age_, static_cast<std::uint8_t>(d), false};
      push(next, to_x, to_y, g);
    }
  }
  return std::nullopt;
}

std::optional<double> ThetaStar::find(const Costmap& map, Cell start, Cell goal) {
  struct Open {
    double f;
    std::uint32_t cell;
    bool operator<(const Open& other) const { return f > other.f; }
  };
  if (nodes_.size() != map.cells()) nodes_.assign(map.cells(), Node{0.0, 0, 0, false});
  ++age_;
  const auto middle = [&](std::uint32_t cell) {
    return geometry::Vector2(cell % map.stride() + 0.5, cell / map.stride() + 0.5);
  };
  const std::uint32_t first = map.index(start.x, start.y), last = map.index(goal.x, goal.y);
  const geometry::Vector2 target = middle(last);
  std::priority_queue<Open> open;
  nodes_[first] = {0.0, first, age_, false};
  open.push({(middle(first) - target).norm(), first});
  while (!open.empty()) {
    const std::uint32_t cell = open.top().cell;
    open.pop();
    Node& here = nodes_[cell];
    if (here.closed) continue;
    here.closed = true;
    if (cell == last) return here.g;
    const std::uint32_t parent = here.parent;
    for (unsigned d = 0; d < planning::directions; ++d) {
      if ((map.infos()[cell] >> d & 1u) == 0) continue;
      const auto next = static_cast<std::uint32_t>(static_cast<int>(cell) + planning::step_x[d] +
                                                   planning::step_y[d] * static_cast<int>(map.stride()));
      Node& there = nodes_[next];
      if (there.age == age_ && there.closed) continue;
      const bool in_sight = std::isfinite(planning::line_cost(map, middle(parent), middle(next)));
      const std::uint32_t from = in_sight ? parent : cell;
      const double g = nodes_[from].g + (middle(from) - middle(next)).norm();
      if (there.age == age_ && there.g <= g) continue;
      there = {g, from, age_, false};
      open.push({g + (middle(next) - target).norm(), next});
    }
  }
  return std::nullopt;
}

}  // namespace kervan::bench
