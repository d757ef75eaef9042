#include <string>
#include <vector>

#include "components/control/controller_shell.hpp"
#include "components/control/dwa.hpp"
#include "components/control/seen_points.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"

namespace kervan::control {
namespace {

using namespace std::chrono_literals;
using geometry::Vector2;
using kervan_msgs::msg::SonarArray;
using sensor_msgs::msg::LaserScan;

enum class Sensor { scan, sonar };

struct DwaComponentParams {
  Duration period = 50ms;
  Sensor sensor = Sensor::scan;
  DwaParams window;
  SeenPointsParams seen;
  geometry::Pose2 mount;
  double arrive_within = 0.2;

  template <class Visitor>
  void describe(Visitor& v) {
    describe_period(period, v);
    v(sensor, "sensor", {.choices = {"scan", "sonar"}, .help = "Which of the inputs says where obstacles are."});
    v(mount, "mount", {.min = -10.0, .max = 10.0, .help = "Pose of the laser in base_link."});
    v(window.hull.front, "front",
      {.unit = "m", .min = 0.01, .max = 10.0, .help = "From base_link to the robot's front."});
    v(window.hull.rear, "rear", {.unit = "m", .min = 0.0, .max = 10.0, .help = "From base_link to its rear."});
    v(window.hull.half_width, "half_width", {.unit = "m", .min = 0.01, .max = 10.0, .help = "Half of its width."});
    v(window.v_max, "v_max", {.unit = "m/s", .min = 0.01, .max = 5.0, .help = "Highest speed forward.", .live = true});
    v(window.v_back, "v_back",
      {.unit = "m/s", .min = 0.0, .max = 2.0, .help = "Highest speed backward; 0: it never backs.", .live = true});
    v(window.turn_rate, "turn_rate",
      {.unit = "rad/s", .min = 0.01, .max = 10.0, .help = "Highest turning rate.", .live = true});
    v(window.acceleration, "acceleration",
      {.unit = "m/s2", .min = 0.01, .max = 20.0, .help = "With which the drive speeds up.", .live = true});
    v(window.deceleration, "deceleration",
      {.unit = "m/s2", .min = 0.01, .max = 20.0, .help = "With which it can be relied on to brake.", .live = true});
    v(window.turn_acceleration, "turn_acceleration",
      {.unit = "rad/s2", .min = 0.01, .max = 100.0, .help = "With which it changes its turning rate.", .live = true});
    v(window.delay, "delay",
      {.unit = "s",
       .min = 0.0,
       .max = 1.0,
       .help = "From a measurement until the drive follows the command that was made of it.",
       .live = true});
    v(window.window, "window",
      {.unit = "s",
       .min = 0.01,
       .max = 5.0,
       .help = "Speeds that are reached within it are thought of.",
       .live = true});
    v(window.horizon, "horizon",
      {.unit = "s", .min = 0.2, .max = 5.0, .help = "How far each of them is driven in thought.", .live = true});
    v(window.margin, "margin",
      {.unit = "m", .min = 0.0, .max = 1.0, .help = "What must stay free around the robot.", .live = true});
    v(window.comfort, "comfort",
      {.unit = "m", .min = 0.0, .max = 1.0, .help = "More room than this is worth nothing.", .live = true});
    v(window.near_cost, "near_cost",
      {.unit = "s", .min = 0.0, .max = 100.0, .help = "Of a metre along an obstacle, at the margin.", .live = true});
    v(window.near_speed, "near_speed",
      {.unit = "m/s", .min = 0.01, .max = 5.0, .help = "That is no haste at the margin.", .live = true});
    v(window.haste_cost, "haste_cost",
      {.unit = "s", .min = 0.0, .max = 100.0, .help = "Of a metre at twice the speed that is no haste.", .live = true});
    v(window.detour_cost, "detour_cost",
      {.unit = "s",
       .min = 0.0,
       .max = 100.0,
       .help = "Of a motion at whose end the straight way to the waypoint is blocked.",
       .live = true});
    v(window.turn_cost, "turn_cost",
      {.unit = "s",
       .min = 0.0,
       .max = 100.0,
       .help = "Of each radian from the heading to the waypoint.",
       .live = true});
    v(window.change_cost, "change_cost",
      {.unit = "s", .min = 0.0, .max = 100.0, .help = "Of a command as different as can be.", .live = true});
    v(seen.reach, "reach",
      {.unit = "m", .min = 0.5, .max = 5.0, .help = "Obstacles farther from the laser are not looked at."});
    v(seen.spacing, "spacing", {.unit = "m", .min = 0.02, .max = 0.2, .help = "Of obstacle points."});
    v(seen.memory, "memory",
      {.min = 0.0, .max = 600.0, .help = "How long obstacles are remembered where the laser cannot look."});
    describe_arrival(arrive_within, v);
  }

  DwaParams of_window() const {
    DwaParams params = window;
    params.period = seconds(period);
    return params;
  }
};

/// Drives a robot by the dynamic window approach (dwa.hpp), past what its laser or its sonars see and have seen.
class DwaComponent final : public ControllerShell<DwaComponentParams> {
  Input<LaserScan> scan_{this, "scan", qos::sensor.max_age(oldest).optional(), &DwaComponent::on_scan,
                         "What the laser measures."};
  Input<SonarArray> sonar_{this, "sonar", qos::sensor.max_age(oldest).optional(), &DwaComponent::on_sonar,
                           "What the sonars hear."};
  DynamicWindow window_{params_.of_window()};
  SeenPoints seen_{params_.seen};
  std::vector<Vector2> echoes_;  // of the last round, in the frame of the odometry
  std::string useless_;          // why the last message of the sensor told nothing

  void on_parameters_changed() override { window_.set_params(params_.of_window()); }

  void on_stand() override { window_.reset(); }

  std::string missing() override { return params_.sensor == Sensor::scan ? scan_.missing() : sonar_.missing(); }

  std::string unready() override { return useless_.empty() ? "" : sensor() + ": " + useless_; }

  std::string sensor() const { return params_.sensor == Sensor::scan ? scan_.name() : sonar_.name(); }

  /// The place of a sensor at `mount`, if it can be told.
  std::optional<geometry::Pose2> placed(const geometry::Pose2& mount) const {
    if (!odometry()) return std::nullopt;
    const geometry::Pose2 pose = geometry::pose_of(odometry()->pose.pose) * mount;
    if (!pose.position().allFinite() || !std::isfinite(pose.yaw)) return std::nullopt;
    return pose;
  }

  void on_scan(const LaserScan& message, Time) {
    if (params_.sensor != Sensor::scan) return;
    const geometry::Scan scan = geometry::scan_of(message);
    const auto laser = placed(params_.mount);
    useless_ = !geometry::possible(scan) ? "its angles or limits are none" : !laser ? "measured from nowhere" : "";
    if (useless_.empty()) seen_.look(*laser, scan, geometry::time_of(message.header.stamp));
  }

  /// An echo is taken to come from the middle of its arc.
  void on_sonar(const SonarArray& round, Time) {
    if (params_.sensor != Sensor::sonar) return;
    const auto robot = placed({});
    useless_ = !(round.max_range > round.min_range) ? "its ranges are none" : !robot ? "heard from nowhere" : "";
    if (!useless_.empty()) return;
    echoes_.clear();
    for (const auto& reading : round.readings) {
      if (!(reading.range >= 0.0F && reading.range <= round.max_range)) continue;
      const Vector2 echo = Vector2(static_cast<double>(reading.x), static_cast<double>(reading.y)) +
                           static_cast<double>(reading.range) * geometry::heading(static_cast<double>(reading.yaw));
      if (echo.allFinite()) echoes_.push_back(*robot * echo);
    }
    seen_.add(echoes_, robot->position(), geometry::time_of(round.header.stamp));
  }

  Controlled control(Time, const RobotState& robot, const Vector2& target) override {
    return {window_.step(robot, target, seen_.points()), "odom"};
  }
};

}  // namespace
}  // namespace kervan::control

KERVAN_COMPONENT(kervan::control::DwaComponent, "control/dwa",
                 "Drives to a waypoint past what its laser or its sonars see, by the dynamic window approach.")
