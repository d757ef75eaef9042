/// What planners on occupancy grids have in common.
#pragma once

#include "components/planning/costmap.hpp"
#include "components/planning/planner.hpp"

namespace kervan::planning {

/// A planner on a costmap that follows an occupancy grid.
class MapPlanner : public Planner {
 public:
  explicit MapPlanner(const CostmapParams& costs) : map_(costs) {}

  /// Follows the map within `box`, as Costmap::update().
  void update(grid::Occupancy& map, const grid::CellBox& box) { map_.update(map, box); }

  const Costmap& costmap() const { return map_; }

 protected:
  Costmap map_;
};

}  // namespace kervan::planning
