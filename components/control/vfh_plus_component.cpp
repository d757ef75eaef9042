#include <spdlog/spdlog.h>

#include <numbers>
#include <string>
#include <utility>

#include "components/control/controller_shell.hpp"
#include "components/control/heading_drive_params.hpp"
#include "components/control/vfh_plus.hpp"
#include "kervan_msgs/msg/PolarHistogram.hpp"

namespace kervan::control {
namespace {

using namespace std::chrono_literals;

struct VfhPlusComponentParams {
  Duration period = 100ms;
  geometry::Pose2 mount;
  VfhPlusParams law;
  HeadingDriveParams drive;
  double arrive_within = 0.1;

  template <class Visitor>
  void describe(Visitor& v) {
    describe_period(period, v);
    v(mount, "mount", {.min = -10.0, .max = 10.0, .help = "Pose of the laser in base_link."});
    const auto distance = [&v](double& value, const char* name, double most, const char* help) {
      v(value, name, {.unit = "m", .min = 0.0, .max = most, .help = help, .live = true});
    };
    distance(law.half_width, "half_width", 5.0, "Half of what the robot's body measures across.");
    distance(law.nose, "nose", 5.0, "From base_link to the front of the robot.");
    distance(law.margin, "margin", 2.0, "Kept between the body and what it drives past.");
    distance(law.block_within, "block_within", 20.0, "An obstacle nearer than this blocks its directions.");
    distance(law.free_beyond, "free_beyond", 20.0, "What was blocked is free again if nothing is nearer than this.");
    v(law.look, "look",
      {.unit = "m", .min = 0.1, .max = 20.0, .help = "What is farther away is not looked at.", .live = true});
    distance(law.remember, "remember", 10.0, "Within this it remembers what goes out of the laser's sight.");
    v(law.mu1, "mu1",
      {.min = 0.0,
       .max = 100.0,
       .help = "Weight of the angle to the waypoint; more than mu2 and mu3, or it does not turn there.",
       .live = true});
    v(law.mu2, "mu2", {.min = 0.0, .max = 100.0, .help = "Weight of the angle to the heading.", .live = true});
    v(law.mu3, "mu3",
      {.min = 0.0, .max = 100.0, .help = "Weight of the angle to the direction chosen before.", .live = true});
    v(law.wide, "wide",
      {.unit = "rad",
       .min = 0.05,
       .max = 3.0,
       .help = "A free valley that is wider is driven through at half of this from its edge.",
       .live = true});
    distance(law.stop_distance, "stop_distance", 2.0, "Between the nose and what it stands before.");
    v(law.delay, "delay",
      {.unit = "s", .min = 0.0, .max = 2.0, .help = "From a scan to when the robot brakes for it.", .live = true});
    v(law.slow_within, "slow_within",
      {.unit = "m",
       .min = 0.001,
       .max = 5.0,
       .help = "It is slower the nearer its body is to something within this.",
       .live = true});
    v(law.least_share, "least_share",
      {.min = 0.0, .max = 1.0, .help = "Of the speed, right beside something.", .live = true});
    control::describe(drive, v);
    describe_arrival(arrive_within, v);
  }
};

/// Drives a robot by VFH+ (vfh_plus.hpp).
class VfhPlusComponent final : public ControllerShell<VfhPlusComponentParams, sensor_msgs::msg::LaserScan> {
  VfhPlus law_{checked(params_).law, params_.drive};
  Output<kervan_msgs::msg::PolarHistogram> histogram_{this, "histogram", qos::sensor,
                                                      "What is how near around the robot, for looking at."};

  static const VfhPlusComponentParams& checked(const VfhPlusComponentParams& params) {
    if (params.law.free_beyond < params.law.block_within)
      throw ParameterError("free_beyond", "it is less than block_within, so between the two all would be both");
    if (params.law.look < params.law.free_beyond)
      throw ParameterError("look", "it is less than free_beyond, so nothing that is blocked would get free again");
    return params;
  }

  void on_parameters_changed() override { law_.set_params(checked(params_).law, params_.drive); }

  void on_stand() override { law_.reset(); }

  Controlled control(Time now, const RobotState& robot, const geometry::Vector2& target) override {
    const Steering steering = law_.step(robot, target, {heard_at() * params_.mount, geometry::scan_of(heard())});
    if (steering.outcome != Outcome::fault) show(now);
    return {steering, "scan"};
  }

  void show(Time now) {
    const VfhPlusView& view = law_.view();
    const auto nearness = [this](double distance) { return static_cast<float>(1.0 - distance / params_.law.look); };
    auto message = histogram_.loan();
    geometry::set_header(message->header, now, frame());
    message->sector_width = static_cast<float>(2.0 * std::numbers::pi / vfh_sectors);
    for (const float distance : view.nearest) message->density.push_back(nearness(static_cast<double>(distance)));
    message->blocked.assign(view.blocked.begin(), view.blocked.end());
    message->low_threshold = nearness(params_.law.free_beyond);
    message->high_threshold = nearness(params_.law.block_within);
    message->has_direction = view.direction.has_value();
    message->direction = static_cast<float>(view.direction.value_or(0.0));
    histogram_.publish(std::move(message));
  }

  void on_shutdown(Time) override {
    if (law_.refused_ranges() > 0) log().warn("left out {} ranges that are no distance", law_.refused_ranges());
  }
};

}  // namespace
}  // namespace kervan::control

KERVAN_COMPONENT(kervan::control::VfhPlusComponent, "control/vfh_plus",
                 "Drives to a waypoint past what its laser sees, by VFH+.")
