/// The component around every planner: its goal, where the robot is, its route. What differs is the planner.
#pragma once

#include <chrono>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/planning/planner.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "nav_msgs/msg/Path.hpp"

namespace kervan::planning {

struct PlannerShellParams {
  double reached_within = 0.3;

  template <class Visitor>
  void describe(Visitor& v) {
    v(reached_within, "reached_within",
      {.unit = "m",
       .min = 0.0,
       .max = 100.0,
       .help = "A goal counts as reached when the robot is this near to it, by its odometry.",
       .live = true});
  }
};

/// Plans once for every goal, from where the robot is then, and says what becomes of the goal. A goal that comes before
/// the first odometry, or before the planner has what it needs, waits for it. A goal without a route gives an empty
/// route and `degraded`.
class PlannerShell : public Component {
 protected:
  virtual const PlannerShellParams& shell_params() const = 0;
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
    if (found.outcome == Outcome::found) {
      announce(found, goal);
      enter(GoalState::GOAL_ACTIVE, {}, now);
      arrive(now);
    } else {
      enter(GoalState::GOAL_FAILED, failure_, now);
    }
    report(now);
  }

 private:
  using GoalState = kervan_msgs::msg::GoalState;

  static constexpr Duration patience = std::chrono::milliseconds(100);  ///< with something that is missing

  Input<geometry_msgs::msg::PoseStamped> goal_{this, "goal", qos::latched, &PlannerShell::on_goal,
                                               "Where the robot is to go, in the map."};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor, &PlannerShell::on_odometry, "Where the robot is."};
  Output<nav_msgs::msg::Path> route_{this, "route", qos::latched, "Waypoints to the goal; empty: there is no route."};
  Output<kervan_msgs::msg::GoalStatus> status_{this, "goal_status", qos::latched, "What has become of the goal."};
  Timer tick_{this, patience, &PlannerShell::report};
  geometry_msgs::msg::PoseStamped wanted_;
  std::optional<GoalState> state_;  ///< of that goal; none before the first
  Time wanted_since_{};
  bool pending_ = false;
  std::string failure_;  ///< of the last plan

  void on_goal(const geometry_msgs::msg::PoseStamped& goal, Time now) {
    if (state_ == GoalState::GOAL_PENDING || state_ == GoalState::GOAL_ACTIVE)
      enter(GoalState::GOAL_CANCELLED, "replaced by another goal", now);
    wanted_ = goal;
    wanted_since_ = now;
    pending_ = true;
    enter(GoalState::GOAL_PENDING, {}, now);
    try_to_plan(now);
  }

  void on_odometry(const nav_msgs::msg::Odometry&, Time now) {
    try_to_plan(now);
    arrive(now);
  }

  /// Straight to the goal, m; NaN without an odometry.
  double distance() const {
    const auto* odometry = odom_.latest();
    if (!odometry) return std::numeric_limits<double>::quiet_NaN();
    return (geometry::position_of(wanted_.pose) - geometry::position_of(odometry->pose.pose)).norm();
  }

  void arrive(Time now) {
    if (state_ == GoalState::GOAL_ACTIVE && distance() <= shell_params().reached_within)
      enter(GoalState::GOAL_REACHED, {}, now);
  }

  void enter(GoalState state, std::string why, Time now) {
    state_ = state;
    auto status = status_.loan();
    geometry::set_header(status->header, now, wanted_.header.frame_id);
    status->goal_id = geometry::goal_id_of(wanted_.header.stamp);
    status->state = state;
    status->reason = std::move(why);
    status->distance = distance();
    status_.publish(std::move(status));
  }

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
