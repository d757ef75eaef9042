#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "components/control/controller_shell.hpp"
#include "components/control/force_display.hpp"
#include "components/control/nearest_echo.hpp"
#include "components/control/potential_field.hpp"

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
    describe_period(period, v);
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
    describe_arrival(arrive_within, v);
  }
};

/// Drives a robot along the force of a potential field (potential_field.hpp).
class PotentialFieldComponent final : public ControllerShell<PotentialFieldParams, kervan_msgs::msg::SonarArray> {
  ForceDisplay display_{this};
  std::vector<std::optional<geometry::Vector2>> heard_;  // by each sonar at last, in the frame of the odometry
  std::optional<geometry::Vector2> obstacle_;            // the nearest of them

  void forget() override {
    obstacle_.reset();
    heard_.clear();
  }

  /// Keeps the echoes where they were heard: by the next tick the robot will have moved on, and of sonars that fire in
  /// turn most have none in this round.
  std::string hear(const kervan_msgs::msg::SonarArray& sonar, const geometry::Pose2& robot) override {
    obstacle_.reset();
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
    return {};
  }

  Controlled control(Time now, const RobotState& robot, const geometry::Vector2& target) override {
    const Force force = force_at(params_.force, robot.pose.position(), target, obstacle_);
    display_.show(now, frame(), robot.pose.position(), force.attraction, force.repulsion);
    return drive_along(params_.drive, force, robot.pose.yaw);
  }
};

}  // namespace
}  // namespace kervan::control

KERVAN_COMPONENT(kervan::control::PotentialFieldComponent, "control/potential_field",
                 "Drives to a waypoint along the force of a potential field, classical or Ge & Cui's.")
