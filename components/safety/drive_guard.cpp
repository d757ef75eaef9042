#include "components/safety/drive_guard.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::safety {
namespace {

/// The value nearest to `target` that can be reached from `value` when its magnitude grows by at most `up` and falls by
/// at most `down`. It stops at zero before it changes sign, because the two sides of zero have different limits.
double approach(double value, double target, double up, double down) {
  if (value < 0.0) return -approach(-value, -target, up, down);
  if (target >= value) return std::min(target, value + up);
  if (value == 0.0) return std::max(target, -up);
  return std::max({target, value - down, 0.0});
}

}  // namespace

geometry::Twist2 DriveGuard::limited(const geometry::Twist2& wanted) const {
  return {std::clamp(wanted.linear, -params_.max_speed, params_.max_speed),
          std::clamp(wanted.angular, -params_.max_turn, params_.max_turn)};
}

void DriveGuard::set_params(const DriveGuardParams& params) {
  params_ = params;
  wanted_ = limited(wanted_);
}

bool DriveGuard::command(Time received, const geometry::Twist2& wanted) {
  if (!std::isfinite(wanted.linear) || !std::isfinite(wanted.angular)) {
    ++refused_;
    return false;
  }
  wanted_ = limited(wanted);
  received_ = received;
  return true;
}

geometry::Twist2 DriveGuard::step(Time now) {
  const bool fresh = received_ && now + params_.period + params_.travel <= *received_ + params_.timeout;
  if (fresh)
    state_ = DriveState::following;
  else if (state_ == DriveState::following)
    state_ = DriveState::braking;
  const geometry::Twist2 target = fresh ? wanted_ : geometry::Twist2{};
  const double passed = seconds(stepped_ ? now - *stepped_ : params_.period);
  const double up = std::min(passed, seconds(params_.period));
  stepped_ = now;
  output_.linear = approach(output_.linear, target.linear, params_.acceleration * up, params_.deceleration * passed);
  output_.angular =
      approach(output_.angular, target.angular, params_.turn_acceleration * up, params_.turn_acceleration * passed);
  return output_;
}

}  // namespace kervan::safety
