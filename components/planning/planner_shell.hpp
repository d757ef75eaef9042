/// The component around every planner: its goal, where the robot is, its route. What differs is the planner.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "components/planning/planner.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "nav_msgs/msg/Path.hpp"

namespace kervan::planning {

/// Plans once for every goal, from where the robot is then. A goal that comes before the first odometry, or before the
/// planner has what it needs, waits for it. A goal without a route gives an empty route and `degraded`.
class PlannerShell : public Component {
 protected:
  /// What the planner needs before it can plan at all, and does not have; empty: nothing.
  virtual std::string needs() const { return {}; }
  /// Good until the next call.
  virtual const Plan& plan(const geometry::Vector2& start, const geometry::Vector2& goal) = 0;
  /// A route was found and published: tells the log.
  virtual void announce(const Plan& plan, const geometry::Vector2& goal) = 0;
  /// What has been wrong with the inputs, as long as the planner works; empty: nothing.
  virtual std::string trouble() const { return {}; }

  /// Something has come that a goal may have been waiting for.
  void try_to_plan(Time now) {
    const auto* odometry = odom_.latest();
    if (!pending_ || !odometry || !needs().empty()) return;
    pending_ = false;
    const geometry::Vector2 goal = geometry::position_of(wanted_.pose);
    const Plan& found = plan(geometry::position_of(odometry->pose.pose), goal);
    publish(found.points, now);
    failure_ = found.why;
    if (found.outcome == Outcome::found) announce(found, goal);
    report(now);
  }

 private:
  static constexpr Duration patience = std::chrono::milliseconds(100);  ///< with something that is missing

  Input<geometry_msgs::msg::PoseStamped> goal_{this, "goal", qos::latched, &PlannerShell::on_goal,
                                               "Where the robot is to go, in the map."};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor, &PlannerShell::on_odometry, "Where the robot is."};
  Output<nav_msgs::msg::Path> route_{this, "route", qos::latched, "Waypoints to the goal; empty: there is no route."};
  Timer tick_{this, patience, &PlannerShell::report};
  geometry_msgs::msg::PoseStamped wanted_;
  Time wanted_since_{};
  bool pending_ = false;
  std::string failure_;  ///< of the last plan

  void on_goal(const geometry_msgs::msg::PoseStamped& goal, Time now) {
    wanted_ = goal;
    wanted_since_ = now;
    pending_ = true;
    try_to_plan(now);
  }

  void on_odometry(const nav_msgs::msg::Odometry&, Time now) { try_to_plan(now); }

  void publish(const std::vector<geometry::Vector2>& points, Time now) {
    auto path = route_.loan_uncleared();
    geometry::set_header(path->header, now, wanted_.header.frame_id);
    path->poses.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      path->poses[i].header = path->header;
      path->poses[i].pose = geometry::to_message(geometry::Pose2{points[i].x(), points[i].y(), 0.0});
    }
    route_.publish(std::move(path));
  }

  void report(Time now) {
    if (pending_) {
      // It may come any moment; only when that goes on is something wrong.
      if (now - wanted_since_ >= patience) report_degraded(odom_.latest() ? needs() : odom_.missing());
    } else if (!failure_.empty()) {
      report_degraded(failure_);
    } else if (const std::string wrong = trouble(); !wrong.empty()) {
      report_degraded(wrong);
    } else {
      report_active();
    }
  }
};

}  // namespace kervan::planning
