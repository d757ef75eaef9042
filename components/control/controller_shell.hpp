/// The component around every controller that drives to a waypoint by its sonars. What differs is the controller.
#pragma once

#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/ForceField.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace kervan::control {

/// What a controller makes of what it knows, in the frame of the odometry.
struct Controlled {
  geometry::Twist2 twist = {};
  geometry::Vector2 attraction = geometry::Vector2::Zero();  ///< the forces behind it, without a unit
  geometry::Vector2 repulsion = geometry::Vector2::Zero();
  std::string fault = {};  ///< why it cannot tell: the robot stands; empty if it can
};

/// Params have the members `period` (Duration) and `arrive_within` (m). Stands, and reports `degraded` with the reason,
/// while an input it needs is missing or stale; stands still at its waypoint until the next comes.
template <class Params>
class ControllerShell : public Component {
 protected:
  /// A round of the sonars, heard with base_link at `robot`. Returns why it is of no use; empty if it is.
  virtual std::string hear(const kervan_msgs::msg::SonarArray& sonar, const geometry::Pose2& robot) = 0;
  /// A round came while the robot did not know where it was.
  virtual void forget() = 0;
  /// One step, every period. `robot`, `goal` are finite; `speed`: along the heading, m/s, as the odometry has it.
  virtual Controlled control(const geometry::Pose2& robot, double speed, const geometry::Vector2& goal) = 0;
  /// The robot stands this period, whatever the controller would say.
  virtual void on_stand() {}
  /// What has been wrong with the inputs, as long as the controller works; empty: nothing.
  virtual std::string trouble() { return {}; }

  const Params& params_ = parameters<Params>();

 private:
  static constexpr Duration oldest = std::chrono::milliseconds(500);

  Input<geometry_msgs::msg::PoseStamped> waypoint_{this, "waypoint", qos::latched, &ControllerShell::on_waypoint,
                                                   "Where to drive, in the frame of the odometry."};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor.max_age(oldest), "Where the robot is."};
  Input<kervan_msgs::msg::SonarArray> sonar_{this, "sonar", qos::sensor.max_age(oldest), &ControllerShell::on_sonar,
                                             "Obstacles around the robot."};
  Output<geometry_msgs::msg::TwistStamped> cmd_vel_{this, "cmd_vel_raw", qos::command, "Speed wanted of base_link."};
  Output<kervan_msgs::msg::ForceField> force_{this, "force", qos::sensor, "The forces on the robot, for looking at."};
  Timer tick_{this, params_.period, &ControllerShell::on_tick};
  std::string unheard_;  ///< why the last sonar round was of no use
  bool arrived_ = false;
  Time activated_{};

  void on_activate(Time now) override { activated_ = now; }

  void on_waypoint(const geometry_msgs::msg::PoseStamped&, Time) { arrived_ = false; }

  void on_sonar(const kervan_msgs::msg::SonarArray& sonar, Time) {
    if (const auto* odometry = odom_.latest()) {
      unheard_ = hear(sonar, geometry::pose_of(odometry->pose.pose));
    } else {
      unheard_ = "heard while the robot did not know where it was";
      forget();
    }
  }

  void on_tick(Time now) {
    for (const std::string& why : {waypoint_.missing(), odom_.missing(), sonar_.missing()})
      if (!why.empty()) return stand(now, why);
    const auto& odometry = *odom_.latest();
    const geometry::Pose2 robot = geometry::pose_of(odometry.pose.pose);
    const geometry::Vector2 goal = geometry::position_of(waypoint_.latest()->pose);
    if (!robot.position().allFinite() || !std::isfinite(robot.yaw)) return stand(now, "odom: the pose is not finite");
    if (!goal.allFinite()) return stand(now, "waypoint: the position is not finite");
    if (!unheard_.empty()) return stand(now, sonar_.name() + ": " + unheard_);

    Controlled controlled = control(robot, odometry.twist.twist.linear.x, goal);
    if (!controlled.fault.empty()) return stand(now, std::move(controlled.fault));
    publish_force(now, odometry.header.frame_id, robot, controlled);
    arrived_ = arrived_ || (goal - robot.position()).norm() <= params_.arrive_within;
    if (arrived_) on_stand();
    command(now, arrived_ ? geometry::Twist2{} : controlled.twist);
    if (std::string why = trouble(); !why.empty())
      report_degraded(std::move(why));
    else
      report_active();
  }

  void on_deactivate(Time now) override { command(now, {}); }

  void stand(Time now, std::string why) {
    on_stand();
    command(now, {});
    // At the first tick nobody can have published yet.
    if (now - activated_ >= params_.period) report_degraded(std::move(why));
  }

  void command(Time now, const geometry::Twist2& twist) {
    auto message = cmd_vel_.loan();
    const auto* odometry = odom_.latest();
    geometry::set_header(message->header, now, odometry ? odometry->child_frame_id : std::string());
    message->twist = geometry::to_message(twist);
    cmd_vel_.publish(std::move(message));
  }

  void publish_force(Time now, const std::string& frame, const geometry::Pose2& robot, const Controlled& controlled) {
    auto message = force_.loan();
    geometry::set_header(message->header, now, frame);
    message->position.x = robot.x;
    message->position.y = robot.y;
    message->attraction.x = controlled.attraction.x();
    message->attraction.y = controlled.attraction.y();
    message->repulsion.x = controlled.repulsion.x();
    message->repulsion.y = controlled.repulsion.y();
    force_.publish(std::move(message));
  }
};

}  // namespace kervan::control
