#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "components/control/nearest_echo.hpp"
#include "components/control/potential_field.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/ForceField.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace kervan::control {
namespace {

using namespace std::chrono_literals;

struct PotentialFieldParams {
  Duration period = 100ms;
  ForceParams force;
  ForceDriveParams drive;
  double arrive_within = 0.03;

  template <class Visitor>
  void describe(Visitor& v) {
    v(period, "period", {.min = 0.01, .max = 1.0, .help = "Time between two commands."});
    v(force.law, "law", {.choices = {"potential_classic", "potential_gecui"}, .help = "How an obstacle repels."});
    v(force.xi, "xi", {.min = 0.0, .max = 100.0, .help = "Attraction for each metre to the waypoint.", .live = true});
    v(force.eta, "eta", {.min = 0.0, .max = 100.0, .help = "Strength of the repulsion.", .live = true});
    v(force.n, "n",
      {.min = 0.0,
       .max = 10.0,
       .help = "Power of the distance to the goal in the repulsion of Ge & Cui.",
       .live = true});
    v(force.rho0, "rho0",
      {.unit = "m", .min = 0.05, .max = 10.0, .help = "An obstacle acts within this distance.", .live = true});
    v(force.rho_g_cap, "rho_g_cap",
      {.unit = "m",
       .min = 0.05,
       .max = 1000.0,
       .help = "The force takes a farther waypoint to be this far.",
       .live = true});
    v(drive.speed, "speed", {.unit = "m/s", .min = 0.0, .max = 2.0, .help = "Speed on a free course.", .live = true});
    v(drive.full_force, "full_force",
      {.min = 0.01, .max = 100.0, .help = "A force of this or more means full speed.", .live = true});
    v(drive.turn_gain, "turn_gain",
      {.unit = "1/s", .min = 0.0, .max = 20.0, .help = "Turning rate per angle to turn.", .live = true});
    v(drive.turn_rate, "turn_rate",
      {.unit = "rad/s", .min = 0.0, .max = 10.0, .help = "Highest turning rate.", .live = true});
    v(drive.stop_distance, "stop_distance",
      {.unit = "m",
       .min = 0.0,
       .max = 5.0,
       .help = "Stands this far from an obstacle, from the robot's centre.",
       .live = true});
    v(drive.braking, "braking",
      {.unit = "m/s2", .min = 0.01, .max = 10.0, .help = "Deceleration it may count on.", .live = true});
    v(arrive_within, "arrive_within",
      {.unit = "m",
       .min = 0.001,
       .max = 1.0,
       .help = "Stands still this near to its waypoint until the next comes.",
       .live = true});
  }
};

/// Drives a robot along the force of a potential field (potential_field.hpp). Stands, and reports `degraded` with the
/// reason, while an input it needs is missing or stale.
class PotentialFieldComponent final : public Component {
  const PotentialFieldParams& params_ = parameters<PotentialFieldParams>();
  Input<geometry_msgs::msg::PoseStamped> waypoint_{this, "waypoint", qos::latched,
                                                   &PotentialFieldComponent::on_waypoint,
                                                   "Where to drive, in the frame of the odometry."};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor.max_age(500ms), "Where the robot is."};
  Input<kervan_msgs::msg::SonarArray> sonar_{this, "sonar", qos::sensor.max_age(500ms),
                                             &PotentialFieldComponent::on_sonar, "Obstacles around the robot."};
  Output<geometry_msgs::msg::TwistStamped> cmd_vel_{this, "cmd_vel_raw", qos::command, "Speed wanted of base_link."};
  Output<kervan_msgs::msg::ForceField> force_{this, "force", qos::sensor, "The forces on the robot, for looking at."};
  Timer tick_{this, params_.period, &PotentialFieldComponent::on_tick};
  std::vector<std::optional<geometry::Vector2>> heard_;  // by each sonar at last, in the frame of the odometry
  std::optional<geometry::Vector2> obstacle_;            // the nearest of them
  bool located_ = false;                                 // the last sonar round came while the robot knew where it was
  bool arrived_ = false;
  Time activated_{};

  void on_activate(Time now) override { activated_ = now; }

  void on_waypoint(const geometry_msgs::msg::PoseStamped&, Time) { arrived_ = false; }

  /// Keeps the echoes where they were heard: by the next tick the robot will have moved on, and of sonars that fire in
  /// turn most have none in this round.
  void on_sonar(const kervan_msgs::msg::SonarArray& sonar, Time) {
    const auto* odometry = odom_.latest();
    located_ = odometry != nullptr;
    obstacle_.reset();
    if (!located_) return heard_.clear();
    const geometry::Pose2 robot = geometry::pose_of(odometry->pose.pose);
    heard_.resize(sonar.readings.size());
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < heard_.size(); ++i) {
      const auto& reading = sonar.readings[i];
      double distance = heard_[i] ? (*heard_[i] - robot.position()).norm() : nearest;
      if (!std::isnan(reading.range)) {
        const SonarEcho echo{
            {static_cast<double>(reading.x), static_cast<double>(reading.y), static_cast<double>(reading.yaw)},
            static_cast<double>(reading.range)};
        const auto point = nearest_echo({&echo, 1}, static_cast<double>(sonar.max_range));
        heard_[i] = point ? std::optional(robot * *point) : std::nullopt;
        distance = point ? point->norm() : nearest;
      }
      if (!(distance < nearest)) continue;
      nearest = distance;
      obstacle_ = heard_[i];
    }
  }

  void on_tick(Time now) {
    for (const std::string& why : {waypoint_.missing(), odom_.missing(), sonar_.missing()})
      if (!why.empty()) return stand(now, why);
    if (!located_) return stand(now, "sonar: heard while the robot did not know where it was");
    const auto& odometry = *odom_.latest();
    const geometry::Pose2 robot = geometry::pose_of(odometry.pose.pose);
    const geometry::Vector2 goal = geometry::position_of(waypoint_.latest()->pose);
    if (!robot.position().allFinite() || !std::isfinite(robot.yaw)) return stand(now, "odom: the pose is not finite");
    if (!goal.allFinite()) return stand(now, "waypoint: the position is not finite");

    const Force force = force_at(params_.force, robot.position(), goal, obstacle_);
    publish_force(now, odometry.header.frame_id, robot, force);
    arrived_ = arrived_ || force.rho_g <= params_.arrive_within;
    command(now, arrived_ ? geometry::Twist2{} : drive_along(params_.drive, force, robot.yaw));
    report_active();
  }

  void on_deactivate(Time now) override { command(now, {}); }

  void stand(Time now, std::string why) {
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

  void publish_force(Time now, const std::string& frame, const geometry::Pose2& robot, const Force& force) {
    auto message = force_.loan();
    geometry::set_header(message->header, now, frame);
    message->position.x = robot.x;
    message->position.y = robot.y;
    message->attraction.x = force.attraction.x();
    message->attraction.y = force.attraction.y();
    message->repulsion.x = force.repulsion.x();
    message->repulsion.y = force.repulsion.y();
    force_.publish(std::move(message));
  }
};

}  // namespace
}  // namespace kervan::control

KERVAN_COMPONENT(kervan::control::PotentialFieldComponent, "control/potential_field",
                 "Drives to a waypoint along the force of a potential field, classical or Ge & Cui's.")
