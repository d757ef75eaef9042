#include "sim/odometry.hpp"

#include <cmath>
#include <stdexcept>

namespace kervan::sim {

Odometry::Odometry(const Pose2& start, const OdometryErrors& errors, double track, const RandomSource& random)
    : pose_(start), errors_(errors), track_(track) {
  if (!(errors.drift >= 0.0 && errors.drift < 1.0 && errors.wheel >= 0.0 && errors.wheel < 1.0))
    throw std::invalid_argument("the odometry error must be in [0, 1)");
  if (!(errors.slip >= 0.0 && std::isfinite(errors.slip) && errors.resolution >= 0.0 &&
        std::isfinite(errors.resolution)))
    throw std::invalid_argument("slip and resolution of the encoders must not be negative");
  auto scales = random.at(RandomUse::odometry_scale, 0, 0);
  distance_scale_ = 1.0 + scales.uniform(-errors.drift, errors.drift);
  turn_scale_ = 1.0 + scales.uniform(-errors.drift, errors.drift);
  auto wheels = random.at(RandomUse::wheel_scale, 0, 0);
  wheel_scale_.left = 1.0 + wheels.uniform(-errors.wheel, errors.wheel);
  wheel_scale_.right = track > 0.0 ? 1.0 + wheels.uniform(-errors.wheel, errors.wheel) : wheel_scale_.left;
}

void Odometry::add(const Motion& motion, const RandomSource& random, Duration now) {
  const Motion believed = encoded(motion, random, now);
  pose_ = advance(pose_, {distance_scale_ * believed.distance, turn_scale_ * believed.turn});
}

Twist2 Odometry::measured(const Twist2& speed) const {
  const Motion believed = scaled_by_wheels({speed.linear, speed.angular});
  return {distance_scale_ * believed.distance, turn_scale_ * believed.turn};
}

Motion Odometry::encoded(const Motion& motion, const RandomSource& random, Duration now) {
  if (errors_.slip == 0.0 && errors_.resolution == 0.0) return scaled_by_wheels(motion);
  WheelTravel travel = wheel_travel(motion, track_);
  const WheelTravel true_way = travel;
  travel.left *= wheel_scale_.left;
  travel.right *= wheel_scale_.right;
  if (errors_.slip > 0.0) {
    auto slip = random.at(RandomUse::wheel_slip, 0, static_cast<std::uint64_t>(now.count()));
    travel.left += errors_.slip * std::sqrt(std::abs(true_way.left)) * slip.gaussian();
    const double right = errors_.slip * std::sqrt(std::abs(true_way.right)) * slip.gaussian();
    travel.right = track_ > 0.0 ? travel.right + right : travel.left;
  }
  if (errors_.resolution > 0.0) {
    rolled_.left += travel.left;
    rolled_.right += travel.right;
    const auto full = [this](double way) { return errors_.resolution * std::floor(way / errors_.resolution); };
    const WheelTravel counted{full(rolled_.left), full(rolled_.right)};
    travel = {counted.left - counted_.left, counted.right - counted_.right};
    counted_ = counted;
  }
  return joined(travel, motion.turn);
}

Motion Odometry::scaled_by_wheels(const Motion& motion) const {
  if (errors_.wheel == 0.0) return motion;
  const WheelTravel travel = wheel_travel(motion, track_);
  return joined({wheel_scale_.left * travel.left, wheel_scale_.right * travel.right}, motion.turn);
}

Motion Odometry::joined(const WheelTravel& travel, double turn) const {
  return {0.5 * (travel.left + travel.right), track_ > 0.0 ? (travel.right - travel.left) / track_ : turn};
}

}  // namespace kervan::sim
