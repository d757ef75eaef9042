/// Plans ways for a round robot over an occupancy grid.
#pragma once

#include <optional>
#include <string_view>

#include "components/planning/costmap.hpp"
#include "components/planning/grid_search.hpp"
#include "components/planning/planner.hpp"
#include "components/planning/string_pulling.hpp"

namespace kervan::planning {

enum class SearchChoice {
  automatic,  ///< jump_point if all free cells cost the same, else canonical
  all_neighbours,
  canonical,
  jump_point,
};

struct GridPlannerParams {
  CostmapParams costs;
  SearchChoice search = SearchChoice::automatic;
  bool any_angle = true;  ///< the way is pulled taut; else its points are the middles of cells
};

/// A* or jump point search on a costmap, pulled taut. A plan begins exactly at the start and ends exactly at the goal,
/// or where it escapes to and how near it comes. Allocates nothing once its buffers have grown to the map.
class GridPlanner final : public Planner {
 public:
  explicit GridPlanner(const GridPlannerParams& params) : params_(params), map_(params.costs) {}

  /// Follows the map within `box`, as Costmap::update().
  void update(grid::Occupancy& map, const grid::CellBox& box) { map_.update(map, box); }

  void plan(const Query& query, Plan& plan) override;

  const Costmap& costmap() const { return map_; }

 private:
  using Cell = GridSearch::Cell;

  struct Place {
    Cell cell;
    geometry::Vector2 point;  // in cells
    double moved;             // cells, from where it was wanted
  };

  std::optional<Cell> cell_at(const geometry::Vector2& point) const;
  Place exactly(const Cell& cell, const geometry::Vector2& point) const;
  std::optional<Place> way_out(const geometry::Vector2& from, double reach) const;
  template <class Good>
  std::optional<Place> nearest(const geometry::Vector2& to, double reach, const Good& good) const;
  SearchRule rule() const;
  Reached search(const Query& query, const Place& start, const Place& goal, SearchRule rule, Plan& plan);
  void write(const Query& query, const Place& start, const Place& goal, Plan& plan);

  GridPlannerParams params_;
  Costmap map_;
  GridSearch search_;
  StringPuller string_;
};

}  // namespace kervan::planning
