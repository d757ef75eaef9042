#include "sim/robot_model.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace kervan::sim {

void require_valid(const RobotModel& model) {
  const auto require = [&](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument("robot model " + model.name + ": " + what);
  };
  const DriveLimits& drive = model.drive;
  for (const double limit :
       {drive.speed, drive.turn_rate, drive.acceleration, drive.deceleration, drive.angular_acceleration})
    require(limit > 0.0 && std::isfinite(limit), "every limit of the drive must be a positive number");
  if (const auto& laser = model.laser) {
    require(laser->beams >= 2, "the laser needs at least 2 beams");
    require(laser->field_of_view > 0.0 && laser->field_of_view < 2.0 * std::numbers::pi,
            "the laser's field of view must be in (0, 2 pi)");
    require(laser->min_range >= 0.0 && laser->min_range < laser->max_range && std::isfinite(laser->max_range),
            "the laser needs 0 <= min_range < max_range");
  }
  const SonarRing& sonars = model.sonars;
  if (sonars.poses.empty()) return;
  require(sonars.min_range >= 0.0 && sonars.min_range < sonars.max_range && std::isfinite(sonars.max_range),
          "the sonars need 0 <= min_range < max_range");
  require(sonars.field_of_view > 0.0 && sonars.field_of_view <= std::numbers::pi,
          "the sonars' field of view must be in (0, pi]");
}

}  // namespace kervan::sim
