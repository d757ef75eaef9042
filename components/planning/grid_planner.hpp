/// Plans ways for a round robot over an occupancy grid.
#pragma once

#include "components/planning/grid_search.hpp"
#include "components/planning/map_planner.hpp"
#include "components/planning/plan_ends.hpp"
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
class GridPlanner final : public MapPlanner {
 public:
  explicit GridPlanner(const GridPlannerParams& params) : MapPlanner(params.costs), params_(params) {}

  void plan(const Query& query, Plan& plan) override;

 private:
  using Cell = GridSearch::Cell;

  SearchRule rule() const;
  Reached search(const Query& query, const Place& start, const Place& goal, SearchRule rule, Plan& plan);
  void write(const Query& query, const Place& start, const Place& goal, Plan& plan);

  GridPlannerParams params_;
  GridSearch search_;
  StringPuller string_;
};

}  // namespace kervan::planning
