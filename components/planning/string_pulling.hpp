/// Ways over a grid, straightened.
#pragma once

#include <vector>

#include "components/planning/costmap.hpp"
#include "components/planning/grid_search.hpp"

namespace kervan::planning {

/// Pulls a way taut, as a string between its ends: keeps of its cells only those where it has to turn, then moves each
/// corner along the lines to its neighbours as far as that makes the way shorter. A line replaces a part of the way if
/// it touches no blocked cell, not even with a corner, and costs no more: on a costmap it may not be shorter for being
/// nearer to obstacles. All points are in cells (Costmap::to_cells).
class StringPuller {
 public:
  /// `path`: neighbours, from the cell that holds `start` to the one that holds `goal`. The result begins with `start`,
  /// ends with `goal`, and is good until the next call.
  const std::vector<geometry::Vector2>& pull(const Costmap& map, const std::vector<GridSearch::Cell>& path,
                                             const geometry::Vector2& start, const geometry::Vector2& goal);

 private:
  bool may_replace(const Costmap& map, std::size_t from, std::size_t to) const;
  void keep_corners(const Costmap& map);
  bool tighten(const Costmap& map);
  geometry::Vector2 cut(const Costmap& map, const geometry::Vector2& before, const geometry::Vector2& corner,
                        const geometry::Vector2& after) const;

  std::vector<geometry::Vector2> points_;
  std::vector<double> costs_;  // of the way up to each point
  std::vector<geometry::Vector2> pulled_;
};

/// Cost of a line in lengths of a cell; infinite if it touches a blocked cell.
double line_cost(const Costmap& map, const geometry::Vector2& a, const geometry::Vector2& b);

}  // namespace kervan::planning
