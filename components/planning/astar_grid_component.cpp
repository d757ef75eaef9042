#include "components/planning/grid_planner.hpp"
#include "components/planning/grid_planner_shell.hpp"

namespace kervan::planning {
namespace {

struct AstarGridParams : GridShellParams {
  SearchChoice search = SearchChoice::automatic;
  bool any_angle = true;
  std::int64_t most_expanded = 0;
  double dearer = 0.2;

  template <class Visitor>
  void describe(Visitor& v) {
    v(costs.clearance, "clearance",
      {.unit = "m", .min = 0.0, .max = 10.0, .help = "Beyond the radius, where nearness to an obstacle costs."});
    v(costs.clearance_cost, "clearance_cost",
      {.min = 0.0,
       .max = Costmap::most_clearance_cost,
       .help = "What a metre costs more right at the radius; 0: only the length counts."});
    v(search, "search",
      {.choices = {"auto", "all_neighbours", "canonical", "jump_point"},
       .help = "Which cells are looked at; auto: jump points if only the length counts, else canonical."});
    v(any_angle, "any_angle", {.help = "The way is pulled taut; else it leads over middles of cells."});
    v(most_expanded, "most_expanded",
      {.min = 0, .max = 1'000'000'000, .help = "Cells that a plan may look at; 0: all.", .live = true});
    v(dearer, "dearer",
      {.min = 0.0,
       .max = 1000.0,
       .help = "There is a new plan when the way left costs more than this share more than it did.",
       .live = true});
    GridShellParams::describe(v);
  }
};

/// Plans by search over the cells (grid_planner.hpp).
class AstarGridComponent final : public GridPlannerShell<AstarGridParams> {
  GridPlanner planner_{{checked_costs(), params_.search, params_.any_angle}};

  CostmapParams checked_costs() const {
    const CostmapParams costs = params_.of_costmap();
    if (params_.search == SearchChoice::jump_point && !Costmap(costs).uniform())
      throw ParameterError("search", "jump_point needs cells that all cost the same; allowed with clearance_cost: 0");
    return costs;
  }

  MapPlanner& planner() override { return planner_; }
  void complete(Query& query) const override { query.most_expanded = static_cast<std::size_t>(params_.most_expanded); }
  std::string effort(const Plan& plan) const override {
    return "looked at " + std::to_string(plan.expanded) + " cells";
  }
  double tolerated_rise() const override { return params_.dearer; }
};

}  // namespace
}  // namespace kervan::planning

KERVAN_COMPONENT(kervan::planning::AstarGridComponent, "planning/astar_grid",
                 "Plans the cheapest way over an occupancy grid.")
