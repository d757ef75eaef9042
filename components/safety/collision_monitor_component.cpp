#include <spdlog/spdlog.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "components/safety/collision_monitor.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"

namespace kervan::safety {
namespace {

using namespace std::chrono_literals;
using geometry::Vector2;

enum class Sensor { scan, sonar };

struct CollisionMonitorComponentParams {
  CollisionMonitorParams monitor;
  Sensor sensor = Sensor::scan;
  geometry::Pose2 mount;

  template <class Visitor>
  void describe(Visitor& v) {
    v(sensor, "sensor", {.choices = {"scan", "sonar"}, .help = "Which of the inputs says where obstacles are."});
    v(mount, "mount", {.min = -10.0, .max = 10.0, .help = "Pose of the laser in base_link."});
    v(monitor.hull.front, "front",
      {.unit = "m", .min = 0.01, .max = 10.0, .help = "From base_link to the robot's front."});
    v(monitor.hull.rear, "rear", {.unit = "m", .min = 0.0, .max = 10.0, .help = "From base_link to its rear."});
    v(monitor.hull.half_width, "half_width", {.unit = "m", .min = 0.01, .max = 10.0, .help = "Half of its width."});
    v(monitor.stop_margin, "stop_margin",
      {.unit = "m",
       .min = 0.0,
       .max = 5.0,
       .help = "The stop zone, around the robot: no motion may bring anything into it.",
       .live = true});
    v(monitor.slow_margin, "slow_margin",
      {.unit = "m", .min = 0.0, .max = 10.0, .help = "The slow zone, around the robot.", .live = true});
    v(monitor.slow_speed, "slow_speed",
      {.unit = "m/s", .min = 0.0, .max = 5.0, .help = "The most with something in the slow zone.", .live = true});
    v(monitor.time_to_collision, "time_to_collision",
      {.unit = "s",
       .min = 0.05,
       .max = 10.0,
       .help = "That has to remain along the commanded arc; with less the command is lowered by as much.",
       .live = true});
    v(monitor.max_reverse, "max_reverse",
      {.unit = "m/s", .min = 0.0, .max = 5.0, .help = "The most backward, where it may be blind.", .live = true});
  }
};

/// Stands between whoever steers and the drive guard (collision_monitor.hpp): each command leaves at once, as far as
/// what the sensor saw last allows.
class CollisionMonitorComponent final : public Component {
  const CollisionMonitorComponentParams& params_ = parameters<CollisionMonitorComponentParams>();
  CollisionMonitor monitor_{params_.monitor};
  Input<sensor_msgs::msg::LaserScan> scan_{this, "scan", qos::sensor.max_age(500ms).optional(),
                                           &CollisionMonitorComponent::on_scan, "What the laser measures."};
  Input<kervan_msgs::msg::SonarArray> sonar_{this, "sonar", qos::sensor.max_age(500ms).optional(),
                                             &CollisionMonitorComponent::on_sonar, "What the sonars hear."};
  Input<geometry_msgs::msg::TwistStamped> wanted_{this, "cmd_vel_raw", qos::command,
                                                  &CollisionMonitorComponent::on_command, "Speed that is wanted."};
  Output<geometry_msgs::msg::TwistStamped> checked_{this, "cmd_vel_checked", qos::command,
                                                    "The same, as far as it leads to no collision."};
  std::vector<Vector2> points_;  // in base_link
  std::string useless_;          // why the last message of the sensor told nothing
  std::uint64_t slowed_ = 0, stopped_ = 0, blind_ = 0;

  void on_parameters_changed() override { monitor_.set_params(params_.monitor); }

  void on_scan(const sensor_msgs::msg::LaserScan& message, Time) {
    if (params_.sensor != Sensor::scan) return;
    const geometry::Scan scan = geometry::scan_of(message);
    points_.clear();
    useless_ = geometry::possible(scan) ? "" : "scan: its angles or limits are none";
    if (!useless_.empty()) return;
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      double range = static_cast<double>(scan.ranges[i]);
      if (range == -std::numeric_limits<double>::infinity()) range = scan.range_min;  // no farther than that
      if (!(range >= scan.range_min && range < scan.range_max)) continue;
      points_.push_back(params_.mount * Vector2(range * geometry::heading(scan.angle_min + static_cast<double>(i) *
                                                                                               scan.angle_increment)));
    }
  }

  /// An echo came from somewhere on an arc: its middle and its ends stand for all of it.
  void on_sonar(const kervan_msgs::msg::SonarArray& sonar, Time) {
    if (params_.sensor != Sensor::sonar) return;
    points_.clear();
    const double half = 0.5 * static_cast<double>(sonar.field_of_view);
    useless_ = half >= 0.0 && half <= std::numbers::pi ? "" : "sonar: its field of view is none";
    if (!useless_.empty()) return;
    for (const auto& reading : sonar.readings) {
      const auto range = static_cast<double>(reading.range);
      if (!(range >= 0.0 && range <= static_cast<double>(sonar.max_range))) continue;
      for (const double angle : {-half, 0.0, half}) {
        const Vector2 point = Vector2(static_cast<double>(reading.x), static_cast<double>(reading.y)) +
                              range * geometry::heading(static_cast<double>(reading.yaw) + angle);
        if (point.allFinite()) points_.push_back(point);
      }
    }
  }

  std::string blind() const {
    const std::string missing = params_.sensor == Sensor::scan ? scan_.missing() : sonar_.missing();
    return missing.empty() ? useless_ : missing;
  }

  void on_command(const geometry_msgs::msg::TwistStamped& wanted, Time) {
    Checked checked;
    if (std::string why = blind(); !why.empty()) {
      ++blind_;
      report_degraded(std::move(why));
    } else {
      checked = monitor_.check(geometry::twist_of(wanted.twist), points_);
      slowed_ += checked.verdict == Verdict::slowed;
      stopped_ += checked.verdict == Verdict::stopped;
      if (checked.verdict == Verdict::stopped)
        report_degraded("cmd_vel_raw: stopped, " + std::string(checked.why));
      else
        report_active();
    }
    auto message = checked_.loan();
    message->header = wanted.header;
    message->twist = geometry::to_message(checked.twist);
    checked_.publish(std::move(message));
  }

  void on_shutdown(Time) override {
    if (slowed_ + stopped_ + blind_ > 0)
      log().info("{} commands slowed, {} stopped, {} while blind", slowed_, stopped_, blind_);
  }
};

}  // namespace
}  // namespace kervan::safety

KERVAN_COMPONENT(kervan::safety::CollisionMonitorComponent, "safety/collision_monitor",
                 "Slows or stops a robot's commands before it collides.")
