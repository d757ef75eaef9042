/// What the grid planner is compared with: textbook searches on the same costmap.
#pragma once

#include <cstdint>
#include <optional>
#include <queue>
#include <vector>

#include "components/planning/costmap.hpp"
#include "components/planning/grid_search.hpp"

namespace kervan::bench {

using Cell = planning::GridSearch::Cell;

/// A* with a binary heap on the planner's own arrays: moves and weights of the costmap, whole costs, labels of earlier
/// searches known by their age. What differs is the open list and that every allowed move is looked at.
class TextbookSearch {
 public:
  /// The cost in lengths of a cell; nothing if there is no way.
  std::optional<double> find(const planning::Costmap& map, Cell start, Cell goal);

  std::size_t expanded() const { return expanded_; }

 private:
  struct Node {
    std::uint64_t g;
    std::uint32_t age;
    std::uint8_t direction;
    bool closed;
  };
  struct Open {
    std::uint64_t f;
    std::uint32_t cell;
    bool operator<(const Open& other) const { return f > other.f; }
  };

  std::vector<Node> nodes_;
  std::uint32_t age_ = 0;
  std::vector<Open> open_;
  std::size_t expanded_ = 0;
};

/// Theta* (Nash, Daniel, Koenig and Felner 2007, "Theta*: Any-Angle Path Planning on Grids", AAAI): A* whose parents
/// are the farthest cells in sight. Lines lead from middle to middle and touch no blocked cell.
class ThetaStar {
 public:
  /// The length in cells; nothing if there is no way.
  std::optional<double> find(const planning::Costmap& map, Cell start, Cell goal);

 private:
  struct Node {
    double g;
    std::uint32_t parent;
    std::uint32_t age;
    bool closed;
  };

  std::vector<Node> nodes_;
  std::uint32_t age_ = 0;
};

}  // namespace kervan::bench
