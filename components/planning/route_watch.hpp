/// What becomes of a route when the map changes.
#pragma once

#include <cstdint>
#include <vector>

#include "components/grid/cells.hpp"
#include "components/planning/costmap.hpp"

namespace kervan::planning {

enum class RouteChange {
  none,
  dearer,   ///< what is left of the route costs so much more that another may be cheaper
  blocked,  ///< a cell of what is left is too near to an obstacle now, and was not
};

/// Remembers what the cells of a route weighed when it was planned, and compares. Cells that were blocked then, where a
/// robot escapes from too near an obstacle, do not count.
class RouteWatch {
 public:
  /// Points in metres, in the frame of the map.
  void watch(const Costmap& map, const std::vector<geometry::Vector2>& points);

  /// From `along` on, m from the beginning of the route. Dearer: by more than the share `tolerated`, 0.2 for a fifth.
  /// What is no longer in the map is blocked.
  RouteChange look(const Costmap& map, double along, double tolerated) const;

 private:
  struct Passed {
    grid::Cell cell;      // of the map
    double along;         // m, where the route leaves it
    double length;        // m, of the route in it
    std::uint8_t weight;  // as in Costmap; 0 outside of the map
  };

  static std::uint8_t weight_at(const Costmap& map, const grid::Cell& cell);

  std::vector<Passed> cells_;
};

}  // namespace kervan::planning
