/// The component around every controller that drives to a waypoint. What differs is the control law, and what it sees.
#pragma once

#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "components/control/control_law.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"

namespace kervan::control {

/// What a component makes of a Steering.
struct Controlled {
  geometry::Twist2 twist = {};
  Outcome outcome = Outcome::drives;
  std::string why = {};  ///< as Steering has it; a fault names the input that it is about

  Controlled() = default;
  Controlled(const geometry::Twist2& command) : twist(command) {}
  /// `input`: that a fault is about.
  Controlled(const Steering& steering, const std::string& input) : twist(steering.twist), outcome(steering.outcome) {
    if (outcome == Outcome::fault) why = input + ": ";
    why += steering.why;
  }
};

/// Of a controller that looks at no obstacles.
struct NoObstacles {};

/// Declare the two parameters that every controller has.
template <class Visitor>
void describe_period(Duration& period, Visitor& v) {
  v(period, "period", {.min = 0.01, .max = 1.0, .help = "Time between two commands."});
}
template <class Visitor>
void describe_arrival(double& arrive_within, Visitor& v) {
  v(arrive_within, "arrive_within",
    {.unit = "m",
     .min = 0.001,
     .max = 2.0,
     .help = "Stands still this near to its waypoint until the next comes.",
     .live = true});
}

/// `Params` have the members `period` (Duration) and `arrive_within` (m). `Obstacles`, if any, is the message of which
/// the controller learns about them: SonarArray on the port `sonar`, or LaserScan on `scan`. Stands, and reports
/// `degraded` with the reason, while an input it needs is missing or stale; stands still at its waypoint until the next
/// comes.
template <class Params, class Obstacles = NoObstacles>
class ControllerShell;

template <class Params>
class ControllerShell<Params, NoObstacles> : public Component {
 protected:
  static constexpr Duration oldest = std::chrono::milliseconds(500);

  /// One step, every period. Pose and target are finite; both, and what is shown for looking at, are in frame().
  virtual Controlled control(Time now, const RobotState& robot, const geometry::Vector2& target) = 0;
  /// The robot stands this period, whatever the controller would say.
  virtual void on_stand() {}
  /// Why it must stand, though pose and waypoint are known; empty: it need not.
  virtual std::string unready() { return {}; }
  /// Of its inputs besides odometry and waypoint; empty if it has them.
  virtual std::string missing() { return {}; }
  /// What has been wrong with the inputs, as long as the controller works; empty: nothing.
  virtual std::string trouble() { return {}; }

  /// Where the robot is; nullptr while nobody knows.
  const nav_msgs::msg::Odometry* odometry() const { return odom_.latest(); }
  const std::string& frame() const { return odom_.latest()->header.frame_id; }

  const Params& params_ = parameters<Params>();

 private:
  Input<geometry_msgs::msg::PoseStamped> waypoint_{this, "waypoint", qos::latched, &ControllerShell::on_waypoint,
                                                   "Where to drive, in the frame of the odometry."};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor.max_age(oldest), "Where the robot is."};
  Output<geometry_msgs::msg::TwistStamped> cmd_vel_{this, "cmd_vel_raw", qos::command, "Speed wanted of base_link."};
  Timer tick_{this, params_.period, &ControllerShell::on_tick};
  bool arrived_ = false;
  Time activated_{};

  void on_activate(Time now) override { activated_ = now; }

  void on_waypoint(const geometry_msgs::msg::PoseStamped&, Time) { arrived_ = false; }

  void on_tick(Time now) {
    for (const std::string& why : {waypoint_.missing(), odom_.missing(), missing()})
      if (!why.empty()) return stand(now, why);
    const auto& odometry = *odom_.latest();
    const RobotState robot{geometry::pose_of(odometry.pose.pose), geometry::twist_of(odometry.twist.twist)};
    const geometry::Vector2 target = geometry::position_of(waypoint_.latest()->pose);
    if (!robot.pose.position().allFinite() || !std::isfinite(robot.pose.yaw))
      return stand(now, "odom: the pose is not finite");
    if (!std::isfinite(robot.twist.linear) || !std::isfinite(robot.twist.angular))
      return stand(now, "odom: the speed is not finite");
    if (!target.allFinite()) return stand(now, "waypoint: the position is not finite");
    if (std::string why = unready(); !why.empty()) return stand(now, std::move(why));

    Controlled controlled = control(now, robot, target);
    if (controlled.outcome == Outcome::fault) return stand(now, std::move(controlled.why));
    arrived_ = arrived_ || (target - robot.pose.position()).norm() <= params_.arrive_within;
    if (arrived_) on_stand();
    command(now, arrived_ ? geometry::Twist2{} : controlled.twist);
    if (std::string why = trouble(); !why.empty())
      report_degraded(std::move(why));
    else if (!arrived_ && controlled.outcome == Outcome::hindered)
      report_degraded(std::move(controlled.why));
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
};

/// The port of a message about obstacles, and why one is of no use to any law; empty if it is.
template <class Message>
struct ObstaclePort;

template <>
struct ObstaclePort<kervan_msgs::msg::SonarArray> {
  static constexpr const char *name = "sonar", *help = "Obstacles around the robot.";
  static std::string useless(const kervan_msgs::msg::SonarArray&) { return {}; }
};

template <>
struct ObstaclePort<sensor_msgs::msg::LaserScan> {
  static constexpr const char *name = "scan", *help = "What the laser measures.";
  static std::string useless(const sensor_msgs::msg::LaserScan& scan) {
    return geometry::possible(geometry::scan_of(scan)) ? "" : "its angles or limits are none";
  }
};

template <class Params, class Obstacles>
class ControllerShell : public ControllerShell<Params, NoObstacles> {
  using Shell = ControllerShell<Params, NoObstacles>;

 protected:
  /// A message came, with base_link at `robot`. Returns why it is of no use; empty if it is.
  virtual std::string hear(const Obstacles&, const geometry::Pose2& /*robot*/) { return {}; }
  /// A message came while the robot did not know where it was.
  virtual void forget() {}

  /// The last message, and where base_link was when it came; in control() there is one, and it is of use.
  const Obstacles& heard() const { return *obstacles_.latest(); }
  const geometry::Pose2& heard_at() const { return heard_at_; }

 private:
  using Port = ObstaclePort<Obstacles>;

  Input<Obstacles> obstacles_{this, Port::name, qos::sensor.max_age(Shell::oldest), &ControllerShell::on_obstacles,
                              Port::help};
  geometry::Pose2 heard_at_;
  std::string unheard_;  ///< why the last message was of no use

  void on_obstacles(const Obstacles& obstacles, Time) {
    if (const auto* odometry = this->odometry()) {
      heard_at_ = geometry::pose_of(odometry->pose.pose);
      unheard_ = Port::useless(obstacles);
      if (unheard_.empty()) unheard_ = hear(obstacles, heard_at_);
    } else {
      unheard_ = "heard while the robot did not know where it was";
      forget();
    }
  }

  std::string missing() final { return obstacles_.missing(); }
  std::string unready() final { return unheard_.empty() ? std::string() : obstacles_.name() + ": " + unheard_; }
};

}  // namespace kervan::control
