#include "sim/drive.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::sim {

Pose2 advance(const Pose2& pose, const Motion& motion) {
  // The chord of the arc points along the mean heading and has the length distance * sin(half) / half.
  const double half = 0.5 * motion.turn;
  const double shortening = half == 0.0 ? 1.0 : std::sin(half) / half;
  const Vector2 moved = motion.distance * shortening * geometry::heading(pose.yaw + half);
  return {pose.x + moved.x(), pose.y + moved.y(), geometry::wrap_angle(pose.yaw + motion.turn)};
}

Ramp ramp(double speed, double target, double acceleration, double deceleration, double time) {
  double travelled = 0.0;
  const bool braking = speed * target < 0.0 || std::abs(target) < std::abs(speed);
  if (braking) {
    const double lowest = speed * target < 0.0 ? 0.0 : target;
    const double needed = std::abs(speed - lowest) / deceleration;
    if (needed > time) {
      const double end = speed - std::copysign(deceleration * time, speed);
      return {end, 0.5 * (speed + end) * time};
    }
    travelled = 0.5 * (speed + lowest) * needed;
    speed = lowest;
    time -= needed;
  }
  const double needed = std::abs(target - speed) / acceleration;
  if (needed > time) {
    const double end = speed + std::copysign(acceleration * time, target - speed);
    return {end, travelled + 0.5 * (speed + end) * time};
  }
  return {target, travelled + 0.5 * (speed + target) * needed + target * (time - needed)};
}

void Drive::command(const Twist2& wanted, Duration now) {
  if (!std::isfinite(wanted.linear) || !std::isfinite(wanted.angular)) {
    ++refused_;
    return;
  }
  wanted_.linear = std::clamp(wanted.linear, -limits_.speed, limits_.speed);
  wanted_.angular = std::clamp(wanted.angular, -limits_.turn_rate, limits_.turn_rate);
  fresh_until_ = now + command_timeout_;
}

Motion Drive::step(Duration now, Duration dt) {
  const bool fresh = now + dt <= fresh_until_;
  target_ = fresh ? wanted_ : Twist2{};
  const double time = seconds(dt);
  const Ramp linear = ramp(speed_.linear, target_.linear, limits_.acceleration, limits_.deceleration, time);
  const Ramp angular =
      ramp(speed_.angular, target_.angular, limits_.angular_acceleration, limits_.angular_acceleration, time);
  speed_ = {linear.speed, angular.speed};
  return {linear.travelled, angular.travelled};
}

}  // namespace kervan::sim
