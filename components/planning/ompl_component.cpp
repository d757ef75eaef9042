#include <chrono>

#include "components/planning/grid_planner_shell.hpp"
#include "components/planning/ompl_budget.hpp"
#include "components/planning/ompl_planner.hpp"

namespace kervan::planning {
namespace {

enum class GoalHeading { any, given };

struct OmplComponentParams : GridShellParams {
  OmplAlgorithm planner = OmplAlgorithm::prm_star;
  OmplSpace space = OmplSpace::plane;
  double turning_radius = 0.5;
  GoalHeading goal_heading = GoalHeading::any;
  bool simplify = true;
  Duration deadline = std::chrono::milliseconds(200);
  std::int64_t seed = 1;

  template <class Visitor>
  void describe(Visitor& v) {
    v(planner, "planner", {.choices = ompl_names(), .help = "OMPL's planner."});
    v(space, "space",
      {.choices = {"plane", "se2", "dubins", "reeds_shepp"},
       .help = "How the robot moves: the first two turn on the spot, dubins drives only forwards."});
    v(turning_radius, "turning_radius",
      {.unit = "m", .min = 0.01, .max = 100.0, .help = "Of the tightest turn; for dubins and reeds_shepp."});
    v(goal_heading, "goal_heading",
      {.choices = {"any", "given"}, .help = "Whether the heading of a goal counts; not in the plane."});
    v(simplify, "simplify", {.help = "What is left of the time makes the way shorter."});
    v(deadline, "deadline",
      {.min = 0.001,
       .max = 10.0,
       .help = "That a plan may take; under lockstep the steps that it is enough for elsewhere.",
       .live = true});
    v(seed, "seed", {.min = 1, .max = 4'294'967'295, .help = "Of the random numbers, under lockstep."});
    GridShellParams::describe(v);
  }
};

/// Plans with a planner of OMPL (ompl_planner.hpp).
class OmplComponent final : public GridPlannerShell<OmplComponentParams> {
  OmplPlanner planner_{of_planner()};

  OmplParams of_planner() const {
    if (!may_plan_in(params_.planner, params_.space)) {
      std::string allowed;
      for (std::size_t i = 0; i < ompl_names().size(); ++i)
        if (may_plan_in(static_cast<OmplAlgorithm>(i), params_.space))
          allowed += (allowed.empty() ? "" : ", ") + ompl_names()[i];
      throw ParameterError("planner", ompl_names()[static_cast<std::size_t>(params_.planner)] +
                                          " takes a way back for as good as the way there, which it is not with space: "
                                          "dubins; allowed: " +
                                          allowed);
    }
    OmplParams params{.costs = params_.of_costmap(),
                      .algorithm = params_.planner,
                      .space = params_.space,
                      .turning_radius = params_.turning_radius,
                      .simplify = params_.simplify,
                      .deadline = seconds(params_.deadline),
                      .seed = static_cast<std::uint32_t>(params_.seed)};
    params.costs.clearance = 0.0;
    return params;
  }

  void on_activate(Time) override {
    if (lockstep() && !repeatable(params_.planner))
      throw ParameterError("planner", ompl_names()[static_cast<std::size_t>(params_.planner)] +
                                          " may give another route for the same seed: not under lockstep");
    planner_.set_cancelled([this] { return superseded(); });
  }
  void on_parameters_changed() override { planner_.set_deadline(seconds(params_.deadline)); }

  MapPlanner& planner() override { return planner_; }
  void complete(Query& query) const override {
    if (lockstep()) query.most_expanded = static_cast<std::size_t>(seconds(params_.deadline) * OmplBudget::steps_per_second);
    if (params_.goal_heading == GoalHeading::any) query.goal_heading.reset();
  }
  std::string effort(const Plan& plan) const override { return "in " + std::to_string(plan.expanded) + " steps"; }
  double tolerated_rise() const override { return 0.0; }
};

}  // namespace
}  // namespace kervan::planning

KERVAN_COMPONENT(kervan::planning::OmplComponent, "planning/ompl",
                 "Plans a way over an occupancy grid with a planner of OMPL.")
