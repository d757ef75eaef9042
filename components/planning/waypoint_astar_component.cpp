#include <spdlog/spdlog.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "components/planning/waypoint_astar.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "nav_msgs/msg/Path.hpp"

namespace kervan::planning {
namespace {

using namespace std::chrono_literals;

constexpr Duration patience = 100ms;  ///< with an odometry that is missing

struct WaypointAstarParams {
  std::vector<geometry::Vector2> nodes;
  std::vector<std::pair<std::int64_t, std::int64_t>> edges;
  std::vector<double> costs;
  double reach = 1.0;

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

const char* why_not(RouteStatus status) {
  switch (status) {
    case RouteStatus::found: return "";
    case RouteStatus::no_path: return "no route: no edges lead from the start to the goal";
    case RouteStatus::start_off_graph: return "no route: no waypoint is within reach of the robot";
    case RouteStatus::goal_off_graph: return "no route: no waypoint is within reach of the goal";
  }
  return "";
}

/// "0-1-2-4-5"
std::string numbers(const std::vector<std::size_t>& nodes) {
  std::string text;
  for (const std::size_t node : nodes) text += (text.empty() ? "" : "-") + std::to_string(node);
  return text;
}

/// m, along the path
double length(const nav_msgs::msg::Path& path) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.poses.size(); ++i)
    sum += (geometry::position_of(path.poses[i].pose) - geometry::position_of(path.poses[i - 1].pose)).norm();
  return sum;
}

/// Plans once for every goal, from where the robot is then. A goal without a route gives an empty route and `degraded`.
class WaypointAstarComponent final : public Component {
  const WaypointAstarParams& params_ = parameters<WaypointAstarParams>();
  WaypointGraph graph_ = graph_of(params_);
  Input<geometry_msgs::msg::PoseStamped> goal_{this, "goal", qos::latched, &WaypointAstarComponent::on_goal,
                                               "Where the robot is to go, in the map."};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor, &WaypointAstarComponent::on_odometry,
                                       "Where the robot is."};
  Output<nav_msgs::msg::Path> route_{this, "route", qos::latched, "Waypoints to the goal; empty: there is no route."};
  Timer tick_{this, patience, &WaypointAstarComponent::on_tick};
  geometry_msgs::msg::PoseStamped wanted_;
  Time wanted_since_{};
  bool pending_ = false;

  void on_goal(const geometry_msgs::msg::PoseStamped& goal, Time now) {
    wanted_ = goal;
    wanted_since_ = now;
    pending_ = true;
    if (const auto* odometry = odom_.latest()) plan(*odometry, now);
  }

  /// A goal may come before the first odometry; only when that goes on is something wrong.
  void on_tick(Time now) {
    if (pending_ && now - wanted_since_ >= patience) report_degraded(odom_.missing());
  }

  void on_odometry(const nav_msgs::msg::Odometry& odometry, Time now) {
    if (pending_) plan(odometry, now);
  }

  void plan(const nav_msgs::msg::Odometry& odometry, Time now) {
    pending_ = false;
    const geometry::Vector2 goal = geometry::position_of(wanted_.pose);
    const Route route = find_route(graph_, geometry::position_of(odometry.pose.pose), goal, params_.reach);

    nav_msgs::msg::Path path;
    geometry::set_header(path.header, now, wanted_.header.frame_id);
    const auto add = [&path](const geometry::Vector2& at) {
      path.poses.emplace_back();
      path.poses.back().header = path.header;
      path.poses.back().pose = geometry::to_message(geometry::Pose2{at.x(), at.y(), 0.0});
    };
    for (const std::size_t node : route.nodes) add(graph_.position(node));
    // The goal need not be a waypoint; the last metres to it are driven straight.
    if (route.status == RouteStatus::found && (graph_.position(route.nodes.back()) - goal).norm() > 1e-3) add(goal);
    route_.publish(path);

    if (route.status == RouteStatus::found) {
      log().info("route to ({:.2f}, {:.2f}) over {}: {:.2f} m", goal.x(), goal.y(), numbers(route.nodes), length(path));
      report_active();
    } else {
      report_degraded(why_not(route.status));
    }
  }
};

}  // namespace
}  // namespace kervan::planning

KERVAN_COMPONENT(kervan::planning::WaypointAstarComponent, "planning/waypoint_astar",
                 "Plans the shortest way over a graph of waypoints.")
