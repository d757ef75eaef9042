/// The parameters of heading_drive.hpp as a component declares them.
#pragma once

#include <numbers>

#include "components/control/heading_drive.hpp"

namespace kervan::control {

template <class Visitor>
void describe(HeadingDriveParams& drive, Visitor& v) {
  v(drive.speed, "speed", {.unit = "m/s", .min = 0.0, .max = 5.0, .help = "Speed on a free course.", .live = true});
  v(drive.turn_gain, "turn_gain",
    {.unit = "1/s", .min = 0.0, .max = 20.0, .help = "Turning rate per angle to turn.", .live = true});
  v(drive.turn_rate, "turn_rate",
    {.unit = "rad/s", .min = 0.0, .max = 10.0, .help = "Highest turning rate.", .live = true});
  v(drive.turn_on_spot, "turn_on_spot",
    {.unit = "rad",
     .min = 0.0,
     .max = std::numbers::pi,
     .help = "Stands while it has more than this to turn.",
     .live = true});
  v(drive.braking, "braking",
    {.unit = "m/s2", .min = 0.01, .max = 10.0, .help = "Deceleration it may count on.", .live = true});
}

}  // namespace kervan::control
