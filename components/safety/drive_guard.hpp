/// The last word on a robot's speed: limits it, and brakes when nobody commands it any more.
#pragma once

#include <cstdint>
#include <optional>

#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::safety {

/// Limits hold for both signs. The defaults are a Pioneer P3-DX as MobileSim drives it.
struct DriveGuardParams {
  Duration period = std::chrono::milliseconds(50);    ///< between two calls of step()
  Duration timeout = std::chrono::milliseconds(250);  ///< age of a command at which the drive brakes, at the latest
  Duration travel = std::chrono::milliseconds(50);    ///< that a command may take on its way from here to the drive
  double max_speed = 1.0;                             ///< m/s
  double max_turn = 1.74;                             ///< rad/s
  double acceleration = 0.3;                          ///< m/s2
  double deceleration = 0.6;                          ///< m/s2, full braking
  double turn_acceleration = 1.74;                    ///< rad/s2, speeding up and slowing down
};

enum class DriveState {
  waiting,    ///< no command has come yet; the robot stands
  following,  ///< the last command is fresh
  braking,    ///< the last command is too old; the robot brakes or stands
};

/// Takes commands as they come and gives one each period. The state is what it last gave, so the output obeys the
/// limits whatever the input does.
class DriveGuard {
 public:
  explicit DriveGuard(const DriveGuardParams& params) : params_(params) {}

  /// Other limits from the next step() on; the output reaches them at the accelerations they hold.
  void set_params(const DriveGuardParams& params);

  /// A command received at `received` on the clock of step(). One with NaN or infinity is no command: it is refused
  /// (false), counted, and the age of the last good one runs on.
  bool command(Time received, const geometry::Twist2& wanted);

  /// Whoever received the last command knows that it is too old, however young it looked when it was given here.
  void forget() { received_.reset(); }

  /// What the drive shall do for one period, from `now` or, if the way to it is long, until `travel` later. Full
  /// braking begins so early that the drive spends no part of a period on a command that has turned too old: no later
  /// than timeout - travel after the last command, and less than a period before that. From then on the speed falls at
  /// `deceleration`, the turning rate at `turn_acceleration`, both to zero, by the time since the last call: one that
  /// comes late makes up for what was missed. Speeding up never takes more than a period at once.
  geometry::Twist2 step(Time now);

  DriveState state() const { return state_; }
  const geometry::Twist2& output() const { return output_; }  ///< what step() gave last
  std::uint64_t refused() const { return refused_; }

 private:
  geometry::Twist2 limited(const geometry::Twist2& wanted) const;

  DriveGuardParams params_;
  std::optional<Time> received_;  // of the last good command, until it is forgotten
  std::optional<Time> stepped_;
  geometry::Twist2 wanted_;
  geometry::Twist2 output_;
  DriveState state_ = DriveState::waiting;
  std::uint64_t refused_ = 0;
};

}  // namespace kervan::safety
