/// The motion of a robot that is to drive in a direction: it turns towards it, and drives the faster the better it
/// looks there.
#pragma once

#include "framework/geometry/pose2.hpp"

namespace kervan::control {

struct HeadingDriveParams {
  double speed = 0.6;         ///< m/s, on a free course
  double turn_gain = 2.0;     ///< 1/s, turning rate for each radian to turn
  double turn_rate = 0.75;    ///< rad/s, the most
  double turn_on_spot = 0.8;  ///< rad; it does not drive while it has more than this to turn
  double braking = 0.5;       ///< m/s2, deceleration that it may count on
};

/// The speed, m/s, from which braking with `braking` m/s2 brings a robot to rest within `room` m, if it goes on as fast
/// for `delay` s before; zero without room.
double stopping_speed(double room, double braking, double delay = 0.0);

/// `error`: rad from the heading to the direction wanted, in (-pi, pi]; `room`: m within which the robot must be able
/// to stand. v = speed · cos(error), or zero beyond turn_on_spot, and no more than the stopping speed; ω = turn_gain ·
/// error, limited to ±turn_rate.
geometry::Twist2 drive_in_direction(const HeadingDriveParams& params, double error, double room);

}  // namespace kervan::control
