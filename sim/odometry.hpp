/// Dead reckoning as a robot does it: from its own wheels, which are a little larger or smaller than it believes.
#pragma once

#include "sim/drive.hpp"
#include "sim/random.hpp"

namespace kervan::sim {

class Odometry {
 public:
  /// Begins at `start`, so that the frame odom coincides with map as long as nothing has drifted. The error per metre
  /// and the error per radian are drawn once, each uniformly from ±`error`.
  Odometry(const Pose2& start, double error, const RandomSource& random) : pose_(start) {
    auto sequence = random.at(RandomUse::odometry_scale, 0, 0);
    distance_scale_ = 1.0 + sequence.uniform(-error, error);
    turn_scale_ = 1.0 + sequence.uniform(-error, error);
  }

  /// Adds what the wheels really did.
  void add(const Motion& motion) {
    pose_ = advance(pose_, {distance_scale_ * motion.distance, turn_scale_ * motion.turn});
  }

  /// Pose of base_link in odom.
  const Pose2& pose() const { return pose_; }

  /// The speed that the robot believes to have when it really has `speed`.
  Twist2 measured(const Twist2& speed) const { return {distance_scale_ * speed.linear, turn_scale_ * speed.angular}; }

 private:
  Pose2 pose_;
  double distance_scale_ = 1.0;
  double turn_scale_ = 1.0;
};

}  // namespace kervan::sim
