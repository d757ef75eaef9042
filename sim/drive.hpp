/// How a drive follows the speed it is told: within its limits, and never on an old command.
#pragma once

#include <chrono>
#include <cstdint>

#include "framework/geometry/pose2.hpp"
#include "sim/robot_model.hpp"

namespace kervan::sim {

using geometry::Twist2;

/// The simulator's own time, since the start of the run.
using Duration = std::chrono::nanoseconds;

constexpr double seconds(Duration d) { return std::chrono::duration<double>(d).count(); }

/// A small movement of the base along an arc: metres along it (negative backwards) and radians turned.
struct Motion {
  double distance = 0.0;
  double turn = 0.0;
};

/// The pose after the base moved along an arc of constant curvature. Exact, with or without turning.
Pose2 advance(const Pose2& pose, const Motion& motion);

/// A speed on its way to another one for some time.
struct Ramp {
  double speed;      ///< at the end
  double travelled;  ///< the integral of the speed, exact
};

/// From `speed` towards `target` in `time` seconds: towards standstill at `deceleration`, away from it at
/// `acceleration`, so that reversing brakes first. Both limits are positive.
Ramp ramp(double speed, double target, double acceleration, double deceleration, double time);

/// Drives base_link forward and backward, and turns it; how its wheels do that is wheels.hpp's.
class Drive {
 public:
  /// Full braking begins no later than `command_timeout` after the last fresh command, whatever happened to whoever
  /// sent it.
  explicit Drive(const DriveLimits& limits, Duration command_timeout = std::chrono::milliseconds(250))
      : limits_(limits), command_timeout_(command_timeout) {}

  /// Takes a new speed at time `now`, clamped to the limits. A speed that is not finite is refused and counted; it does
  /// not keep the drive going.
  void command(const Twist2& wanted, Duration now);

  /// Moves on from `now` by `dt`. A step in which the last command would become too old is braked from its beginning.
  Motion step(Duration now, Duration dt);

  /// Something outside of the drive stopped the base.
  void stop_driving() { speed_.linear = 0.0; }
  void stop_turning() { speed_.angular = 0.0; }

  const Twist2& speed() const { return speed_; }
  /// What it was on its way to in the last step: the latest command, or standstill once that was too old.
  const Twist2& target() const { return target_; }
  std::uint64_t refused_commands() const { return refused_; }

 private:
  DriveLimits limits_;
  Duration command_timeout_;
  Twist2 speed_;
  Twist2 wanted_;
  Twist2 target_;
  Duration fresh_until_{0};
  std::uint64_t refused_ = 0;
};

}  // namespace kervan::sim
