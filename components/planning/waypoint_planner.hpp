/// Ways over a graph of waypoints, as every planner gives them.
#pragma once

#include <string_view>
#include <utility>

#include "components/planning/planner.hpp"
#include "components/planning/waypoint_astar.hpp"

namespace kervan::planning {

/// find_route() between points. The plan's points are waypoints; a goal that is no waypoint itself is added as the
/// last one, to be driven to in a straight line. Of the query it looks at start and goal only: how far these may lie
/// from a waypoint is `reach`, m, and a graph needs no limit.
class WaypointPlanner final : public Planner {
 public:
  WaypointPlanner(WaypointGraph graph, double reach) : graph_(std::move(graph)), reach_(reach) {}

  void set_reach(double reach) { reach_ = reach; }

  void plan(const Query& query, Plan& plan) override {
    route_ = find_route(graph_, query.start, query.goal, reach_);
    plan = Plan{};
    plan.outcome = route_.outcome;
    plan.why = why_not(route_.outcome);
    plan.cost = route_.cost;
    plan.expanded = route_.expanded;
    for (const std::size_t node : route_.nodes) plan.points.push_back(graph_.position(node));
    if (route_.outcome != Outcome::found) return;
    if ((plan.points.back() - query.goal).norm() > 1e-3) plan.points.push_back(query.goal);
    for (std::size_t i = 1; i < plan.points.size(); ++i) plan.length += (plan.points[i] - plan.points[i - 1]).norm();
    plan.start_moved = (plan.points.front() - query.start).norm();
  }

  /// The numbers of the last plan's waypoints.
  const std::vector<std::size_t>& nodes() const { return route_.nodes; }

 private:
  static std::string_view why_not(Outcome outcome) {
    switch (outcome) {
      case Outcome::no_path: return "no route: no edges lead from the start to the goal";
      case Outcome::start_outside: return "no route: no waypoint is within reach of the robot";
      case Outcome::goal_outside: return "no route: no waypoint is within reach of the goal";
      default: return {};
    }
  }

  WaypointGraph graph_;
  double reach_;
  Route route_;
};

}  // namespace kervan::planning
