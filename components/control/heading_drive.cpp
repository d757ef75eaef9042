#include "components/control/heading_drive.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::control {

double stopping_speed(double room, double braking, double delay) {
  const double lost = braking * delay;
  return std::max(0.0, std::sqrt(lost * lost + 2.0 * braking * std::max(0.0, room)) - lost);
}

geometry::Twist2 drive_in_direction(const HeadingDriveParams& params, double error, double room) {
  const bool turns_on_spot = std::abs(error) > params.turn_on_spot;
  const double v = turns_on_spot ? 0.0 : params.speed * std::max(0.0, std::cos(error));
  return {std::min(v, stopping_speed(room, params.braking)),
          std::clamp(params.turn_gain * error, -params.turn_rate, params.turn_rate)};
}

}  // namespace kervan::control
