/// The component around every planner: its goals, where the robot is, its route, and when to plan again. What differs
/// is the planner.
#pragma once

#include <chrono>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/planning/planner.hpp"
#include "components/planning/replan_policy.hpp"
#include "components/planning/route_watch.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "kervan_msgs/msg/ReplanRequest.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "nav_msgs/msg/Path.hpp"

namespace kervan::planning {

struct PlannerShellParams {
  double reached_within = 0.3;
  ReplanParams replan;

  template <class Visitor>
  void describe(Visitor& v) {
    v(reached_within, "reached_within",
      {.unit = "m",
       .min = 0.0,
       .max = 100.0,
       .help = "A goal counts as reached when the robot is this near to it, by its odometry.",
       .live = true});
    v(replan.deviation, "deviation",
      {.unit = "m",
       .min = 0.0,
       .max = 100.0,
       .help = "Farther from its route than this, the robot gets a new one; 0: never.",
       .live = true});
    v(replan.progress, "progress",
      {.unit = "m", .min = 0.01, .max = 100.0, .help = "That the way left has to become shorter …", .live = true});
    v(replan.progress_within, "progress_within",
      {.min = 0.0, .max = 3600.0, .help = "… in this time, or there is a new plan; 0: however long.", .live = true});
    v(replan.interval, "interval",
      {.min = 0.0, .max = 3600.0, .help = "Two plans are this far apart at least.", .live = true});
    v(replan.retry, "retry",
      {.min = 0.0, .max = 3600.0, .help = "Time from a plan without a route to the next try.", .live = true});
    v(replan.tries, "tries",
      {.min = 1,
       .max = 1'000'000,
       .help = "A goal is given up after so many plans in a row without a route or without progress.",
       .live = true});
    v(replan.time_limit, "time_limit",
      {.min = 0.0, .max = 1e6, .help = "A goal not reached in this time is given up; 0: never.", .live = true});
  }
};

/// Plans for every goal, from where the robot is then, again whenever that is called for (replan_policy.hpp), and says
/// what becomes of the goal. A goal that comes before the first odometry, or before the planner has what it needs,
/// waits for it. Where there is no route any more that may be driven, an empty one makes the robot stop.
class PlannerShell : public Component {
 protected:
  virtual const PlannerShellParams& shell_params() const = 0;
  /// What the planner needs before it can plan at all, and does not have; empty: nothing.
  virtual std::string needs() const { return {}; }
  /// Good until the next call.
  virtual const Plan& plan(const geometry::Pose2& start, const geometry::Pose2& goal) = 0;
  /// What has become of the last plan's points from `along` on, m from their beginning; asked often.
  virtual RouteChange route_change(double along) {
    static_cast<void>(along);
    return RouteChange::none;
  }
  /// A route was found and published: tells the log. `again`: why there is another one; empty if it is the first.
  virtual void announce(const Plan& plan, const geometry::Vector2& goal, const std::string& again) = 0;
  /// What has been wrong with the inputs, as long as the planner works; empty: nothing.
  virtual std::string trouble() const { return {}; }

  /// Another goal has come while a plan is being made: nobody needs that plan any more.
  bool superseded() const { return goal_.waiting() || goals_.waiting(); }

  /// A goal waits for its first plan.
  bool waiting() const { return under_way() && !planned_; }

  /// Something has come that a goal may have been waiting for, or that may call for another route.
  void try_to_plan(Time now) {
    const auto* odometry = odom_.latest();
    if (!under_way() || !odometry || !needs().empty()) return;
    const geometry::Pose2 robot = geometry::pose_of(odometry->pose.pose);
    policy_.set_params(shell_params().replan);
    policy_.move(now, robot.position());
    if (arrive(robot.position(), now)) return;
    if (policy_.route_is_good()) switch (route_change(policy_.place().along())) {
        case RouteChange::none: break;
        case RouteChange::dearer: policy_.ask("the route has become dearer"); break;
        case RouteChange::blocked: policy_.blocked(); break;
      }
    switch (policy_.step(now)) {
      case ReplanPolicy::Step::wait: return;
      case ReplanPolicy::Step::give_up: return fail(policy_.reason(), now);
      case ReplanPolicy::Step::plan: return make_plan(robot, now);
    }
  }

 private:
  using GoalState = kervan_msgs::msg::GoalState;

  struct Goal {
    std::string id;
    std::string frame;
    geometry::Pose2 at;
  };

  static constexpr Duration patience = std::chrono::milliseconds(100);  ///< with something that is missing

  Input<geometry_msgs::msg::PoseStamped> goal_{this, "goal", qos::latched, &PlannerShell::on_goal,
                                               "Where the robot is to go, in the map."};
  Input<nav_msgs::msg::Path> goals_{this, "goals", qos::latched.optional(), &PlannerShell::on_goals,
                                    "Goals, to be driven to one after the other; none: the robot is to stay."};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor, &PlannerShell::on_odometry, "Where the robot is."};
  Input<kervan_msgs::msg::ReplanRequest> replan_{this, "replan", qos::event.optional(), &PlannerShell::on_replan,
                                                 "Asks for a new plan, or to give the goal up."};
  Output<nav_msgs::msg::Path> route_{this, "route", qos::latched, "Waypoints to the goal; empty: there is no route."};
  Output<kervan_msgs::msg::GoalStatus> status_{this, "goal_status", qos::latched, "What has become of the goal."};
  Timer tick_{this, patience, &PlannerShell::on_tick};
  ReplanPolicy policy_{ReplanParams{}};
  std::vector<Goal> list_;          ///< the goals from the present one on
  std::optional<GoalState> state_;  ///< of the present goal; none before the first
  Time wanted_since_{};
  bool planned_ = false;   ///< for the present goal, with or without a route
  bool answered_ = false;  ///< a route to it was published, be it an empty one
  bool driving_ = false;   ///< the last route was not empty
  geometry::Vector2 route_end_ = geometry::Vector2::Zero();
  double goal_moved_ = 0.0;  ///< m, from the route's end to the goal
  std::string failure_;      ///< of the last plan

  bool under_way() const { return state_ == GoalState::GOAL_PENDING || state_ == GoalState::GOAL_ACTIVE; }

  void on_goal(const geometry_msgs::msg::PoseStamped& goal, Time now) {
    send_to({{geometry::goal_id_of(goal.header.stamp), goal.header.frame_id, geometry::pose_of(goal.pose)}}, now);
  }

  void on_goals(const nav_msgs::msg::Path& goals, Time now) {
    std::vector<Goal> list;
    for (const auto& pose : goals.poses)
      list.push_back({geometry::goal_id_of(goals.header.stamp) + "/" + std::to_string(list.size() + 1),
                      goals.header.frame_id, geometry::pose_of(pose.pose)});
    send_to(std::move(list), now);
  }

  void send_to(std::vector<Goal> list, Time now) {
    if (under_way()) enter(GoalState::GOAL_CANCELLED, list.empty() ? "withdrawn" : "replaced by another goal", now);
    if (list.empty()) {
      policy_.end();
      if (driving_) publish({}, now);
      return;
    }
    list_ = std::move(list);
    begin(now);
    try_to_plan(now);
  }

  void begin(Time now) {
    wanted_since_ = now;
    planned_ = answered_ = false;
    goal_moved_ = 0.0;
    policy_.begin(now);
    enter(GoalState::GOAL_PENDING, {}, now);
  }

  void on_odometry(const nav_msgs::msg::Odometry&, Time now) { try_to_plan(now); }

  void on_replan(const kervan_msgs::msg::ReplanRequest& request, Time now) {
    if (!under_way()) return;
    if (request.give_up) return fail(request.reason, now);
    policy_.ask(request.reason);
    try_to_plan(now);
  }

  void on_tick(Time now) {
    try_to_plan(now);
    report(now);
  }

  void make_plan(const geometry::Pose2& robot, Time now) {
    const bool again = std::exchange(planned_, true);
    const geometry::Pose2 goal = list_.front().at;
    const Plan& found = plan(robot, goal);
    failure_ = found.why;
    if (found.outcome == Outcome::found) {
      policy_.planned(now, found.points);
      route_end_ = found.points.back();
      goal_moved_ = found.goal_moved;
      publish(found, now);
      announce(found, goal.position(), again ? policy_.reason() : std::string());
      if (state_ != GoalState::GOAL_ACTIVE) enter(GoalState::GOAL_ACTIVE, {}, now);
      arrive(robot.position(), now);
    } else {
      policy_.failed(now, found.why);
      if (!policy_.route_is_good()) stop(now);
      // What is no place will not become one.
      if (!goal.position().allFinite()) return fail(failure_, now);
      if (policy_.step(now) == ReplanPolicy::Step::give_up) return fail(policy_.reason(), now);
    }
    report(now);
  }

  /// The present goal has failed, and with it those behind it.
  void fail(std::string why, Time now) {
    policy_.end();
    stop(now);
    failure_ = why;
    enter(GoalState::GOAL_FAILED, std::move(why), now);
    report(now);
  }

  /// The robot is to stay where it is.
  void stop(Time now) {
    if (driving_ || !answered_) publish({}, now);
  }

  /// If the present goal is reached, the next one is planned for when the robot has moved on.
  bool arrive(const geometry::Vector2& robot, Time now) {
    if (state_ != GoalState::GOAL_ACTIVE) return false;
    const double within = shell_params().reached_within;
    const bool at_end = goal_moved_ > 0.0 && (route_end_ - robot).norm() <= within;
    if (!at_end && !((list_.front().at.position() - robot).norm() <= within)) return false;
    policy_.end();
    enter(GoalState::GOAL_REACHED, goal_moved_ > 0.0 ? "as near as there is a free place" : "", now);
    if (list_.size() == 1) return true;
    list_.erase(list_.begin());
    begin(now);
    return true;
  }

  /// Straight to the goal, m; NaN without an odometry.
  double distance() const {
    const auto* odometry = odom_.latest();
    if (!odometry) return std::numeric_limits<double>::quiet_NaN();
    return (list_.front().at.position() - geometry::position_of(odometry->pose.pose)).norm();
  }

  void enter(GoalState state, std::string why, Time now) {
    state_ = state;
    auto status = status_.loan();
    geometry::set_header(status->header, now, list_.front().frame);
    status->goal_id = list_.front().id;
    status->state = state;
    status->reason = std::move(why);
    status->distance = distance();
    status_.publish(std::move(status));
  }

  void publish(const Plan& plan, Time now) {
    answered_ = true;
    driving_ = !plan.points.empty();
    auto path = route_.loan_uncleared();
    geometry::set_header(path->header, now, list_.front().frame);
    path->poses.resize(plan.points.size());
    for (std::size_t i = 0; i < plan.points.size(); ++i) {
      path->poses[i].header = path->header;
      const double heading = plan.headings.empty() ? 0.0 : plan.headings[i];
      path->poses[i].pose = geometry::to_message(geometry::Pose2{plan.points[i].x(), plan.points[i].y(), heading});
    }
    route_.publish(std::move(path));
  }

  void report(Time now) {
    if (waiting()) {
      // It may come any moment; only when that goes on is something wrong.
      if (now - wanted_since_ < patience) return;
      if (const std::string missing = odom_.latest() ? needs() : odom_.missing(); !missing.empty())
        report_degraded(missing);
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
