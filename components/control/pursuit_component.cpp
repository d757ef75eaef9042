#include <string>

#include "components/control/controller_shell.hpp"
#include "components/control/heading_drive_params.hpp"
#include "components/control/pursuit.hpp"

namespace kervan::control {
namespace {

using namespace std::chrono_literals;

struct PursuitParams {
  Duration period = 100ms;
  HeadingDriveParams drive;
  double arrive_within = 0.1;

  template <class Visitor>
  void describe(Visitor& v) {
    describe_period(period, v);
    control::describe(drive, v);
    describe_arrival(arrive_within, v);
  }
};

/// Drives a robot straight at its waypoint (pursuit.hpp).
class PursuitComponent final : public ControllerShell<PursuitParams> {
  Controlled control(Time, const RobotState& robot, const geometry::Vector2& target) override {
    return {pursue(params_.drive, robot, target), "odom"};
  }
};

}  // namespace
}  // namespace kervan::control

KERVAN_COMPONENT(kervan::control::PursuitComponent, "control/pursuit",
                 "Drives straight at a waypoint and looks at no obstacle.")
