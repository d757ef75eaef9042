/// Dead reckoning as a robot does it: from its own wheels, which are a little larger or smaller than it believes, slip,
/// and are counted in ticks.
///
/// The encoders say of each wheel how far it rolled: its true way, times a scale of its own, plus what it slipped. That
/// is Gaussian with a variance of slip² for each metre, however it is cut into steps (Siegwart and Nourbakhsh,
/// Introduction to Autonomous Mobile Robots, 5.2.4). Over a straight way L the two wheels of a differential drive with
/// the track b thus drift by slip √(L / 2) along the way and by slip √(2 L) / b in yaw. The encoders count full ticks.
/// What they say is scaled per metre and per radian in addition. A synchro drive has one encoder for all wheels; its
/// steering is scaled only.
#pragma once

#include "sim/drive.hpp"
#include "sim/random.hpp"
#include "sim/wheels.hpp"

namespace kervan::sim {

class Odometry {
 public:
  /// Begins at `start`, so that the frame odom coincides with map as long as nothing has drifted. All scale errors are
  /// drawn here, uniformly from ± their bounds. `track` as in wheel_travel(). Throws std::invalid_argument if an error
  /// is out of its range.
  Odometry(const Pose2& start, const OdometryErrors& errors, double track, const RandomSource& random);

  /// Adds what the base really did in the step that began at `now`. A wheel that an obstacle stops does not turn.
  void add(const Motion& motion, const RandomSource& random, Duration now);

  /// Pose of base_link in odom.
  const Pose2& pose() const { return pose_; }

  /// The speed that the robot believes to have when it really has `speed`: with all scale errors, without slip and
  /// ticks.
  Twist2 measured(const Twist2& speed) const;

 private:
  /// What the encoders make of a movement, before the scales per metre and radian.
  Motion encoded(const Motion& motion, const RandomSource& random, Duration now);
  Motion scaled_by_wheels(const Motion& motion) const;
  Motion joined(const WheelTravel& travel, double turn) const;

  Pose2 pose_;
  OdometryErrors errors_;
  double track_;
  double distance_scale_ = 1.0;
  double turn_scale_ = 1.0;
  WheelTravel wheel_scale_{1.0, 1.0};
  WheelTravel rolled_;   // since the start, as the encoders feel it
  WheelTravel counted_;  // of that, in full ticks
};

}  // namespace kervan::sim
