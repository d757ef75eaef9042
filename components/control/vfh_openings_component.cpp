#include <string>

#include "components/control/controller_shell.hpp"
#include "components/control/heading_drive_params.hpp"
#include "components/control/vfh_openings.hpp"

namespace kervan::control {
namespace {

using namespace std::chrono_literals;

struct VfhOpeningsParams {
  Duration period = 100ms;
  geometry::Pose2 mount;
  OpeningParams openings;
  HeadingDriveParams drive;
  double arrive_within = 0.1;

  template <class Visitor>
  void describe(Visitor& v) {
    describe_period(period, v);
    v(mount, "mount", {.min = -10.0, .max = 10.0, .help = "Pose of the laser in base_link."});
    v(openings.free_range, "free_range",
      {.unit = "m", .min = 0.0, .max = 100.0, .help = "A beam is free if it sees farther.", .live = true});
    v(openings.least_width, "least_width",
      {.min = 0.0, .max = 180.0, .help = "Degrees from edge to edge of the narrowest opening.", .live = true});
    v(openings.a, "a",
      {.min = 0.0, .max = 1000.0, .help = "Weight of the angle to the target; only ratios matter.", .live = true});
    v(openings.b, "b", {.min = 0.0, .max = 1000.0, .help = "Weight of the angle to the heading.", .live = true});
    v(openings.c, "c",
      {.min = 0.0, .max = 1000.0, .help = "Weight of the angle to the direction chosen before.", .live = true});
    v(openings.clip, "clip",
      {.help = "Wide openings are driven through where the target is, not in the middle: not the paper's rule.",
       .live = true});
    control::describe(drive, v);
    describe_arrival(arrive_within, v);
  }
};

/// Drives a robot through openings that its laser sees (vfh_openings.hpp).
class VfhOpeningsComponent final : public ControllerShell<VfhOpeningsParams, sensor_msgs::msg::LaserScan> {
  VfhOpenings law_{checked(params_).openings, params_.drive};

  static const VfhOpeningsParams& checked(const VfhOpeningsParams& params) {
    if (!(params.openings.a + params.openings.b + params.openings.c > 0.0))
      throw ParameterError("a", "a, b and c are all zero, so no opening would be better than another");
    return params;
  }

  void on_parameters_changed() override { law_.set_params(checked(params_).openings, params_.drive); }

  void on_stand() override { law_.reset(); }

  Controlled control(Time, const RobotState& robot, const geometry::Vector2& target) override {
    return {law_.step(robot, target, {heard_at() * params_.mount, geometry::scan_of(heard())}), "scan"};
  }
};

}  // namespace
}  // namespace kervan::control

KERVAN_COMPONENT(kervan::control::VfhOpeningsComponent, "control/vfh_openings",
                 "Drives to a waypoint through the opening that its laser sees and that costs least.")
