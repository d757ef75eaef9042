#include <spdlog/spdlog.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "components/planning/planner_shell.hpp"
#include "components/planning/waypoint_planner.hpp"

namespace kervan::planning {
namespace {

struct WaypointAstarParams {
  std::vector<geometry::Vector2> nodes;
  std::vector<std::pair<std::int64_t, std::int64_t>> edges;
  std::vector<double> costs;
  double reach = 1.0;
  // The graph does not change: planning again by itself would bring the same route.
  PlannerShellParams shell{.replan = {.deviation = 0.0, .progress_within = {}, .tries = 1}};

  template <class Visitor>
  void describe(Visitor& v) {
    v(nodes, "nodes",
      {.unit = "m", .min = -1e6, .max = 1e6, .help = "Waypoints in the map, numbered from 0.", .required = true});
    v(edges, "edges", {.help = "Pairs of waypoints joined by a free straight line.", .required = true});
    v(costs, "costs", {.unit = "m", .min = 0.0, .help = "One for each edge, at least its length; none: the lengths."});
    v(reach, "reach",
      {.unit = "m",
       .min = 0.0,
       .max = 100.0,
       .help = "Farthest start and goal may lie from a waypoint.",
       .live = true});
    shell.describe(v);
  }
};

WaypointGraph graph_of(const WaypointAstarParams& params) {
  if (!params.costs.empty() && params.costs.size() != params.edges.size())
    throw ParameterError("costs", std::to_string(params.costs.size()) + " costs for " +
                                      std::to_string(params.edges.size()) + " edges; allowed: one for each, or none");
  WaypointGraph graph(params.nodes);
  for (std::size_t i = 0; i < params.edges.size(); ++i) {
    const std::string edge = "edges[" + std::to_string(i) + "]";
    if (const auto least = std::min(params.edges[i].first, params.edges[i].second); least < 0)
      throw ParameterError(edge, "there is no node " + std::to_string(least) + "; nodes are counted from 0");
    const auto a = static_cast<std::size_t>(params.edges[i].first),
               b = static_cast<std::size_t>(params.edges[i].second);
    try {
      params.costs.empty() ? graph.connect(a, b) : graph.connect(a, b, params.costs[i]);
    } catch (const std::invalid_argument& error) {
      throw ParameterError(edge, error.what());
    }
  }
  return graph;
}

/// "0-1-2-4-5"
std::string numbers(const std::vector<std::size_t>& nodes) {
  std::string text;
  for (const std::size_t node : nodes) text += (text.empty() ? "" : "-") + std::to_string(node);
  return text;
}

/// Plans over a graph of waypoints (waypoint_astar.hpp).
class WaypointAstarComponent final : public PlannerShell {
  const WaypointAstarParams& params_ = parameters<WaypointAstarParams>();
  WaypointPlanner planner_{graph_of(params_), params_.reach};
  Plan plan_;

  const PlannerShellParams& shell_params() const override { return params_.shell; }

  void on_parameters_changed() override { planner_.set_reach(params_.reach); }

  const Plan& plan(const geometry::Pose2& start, const geometry::Pose2& goal) override {
    planner_.plan({.start = start.position(), .goal = goal.position()}, plan_);
    return plan_;
  }

  void announce(const Plan& plan, const geometry::Vector2& goal, const std::string& again) override {
    if (!again.empty()) log().info("plans again: {}", again);
    log().info("route to ({:.2f}, {:.2f}) over {}: {:.2f} m", goal.x(), goal.y(), numbers(planner_.nodes()),
               plan.length);
  }
};

}  // namespace
}  // namespace kervan::planning

KERVAN_COMPONENT(kervan::planning::WaypointAstarComponent, "planning/waypoint_astar",
                 "Plans the shortest way over a graph of waypoints.")
