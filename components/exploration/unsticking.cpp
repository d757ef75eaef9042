#include "components/exploration/unsticking.hpp"

#include <cmath>

namespace kervan::exploration {
namespace {

Duration patience(double nominal) { return from_seconds(2.0 * nominal + 1.0); }

}  // namespace

bool StuckDetector::look(Time now, const geometry::Vector2& position, bool commanded) {
  if (!place_ || !((position - *place_).norm() < params_.distance)) {
    place_ = position;
    held_ = {};
  } else if (commanded) {
    held_ += now - looked_;
  }
  looked_ = now;
  return held_ >= params_.time;
}

void BackOff::start(Time now, const geometry::Pose2& pose, double turn) {
  part_ = Part::back;
  turn_ = turn;
  last_ = pose;
  until_ = now + patience(params_.distance / params_.speed);
}

std::optional<geometry::Twist2> BackOff::step(Time now, const geometry::Pose2& pose) {
  if (part_ == Part::back) {
    if (now < until_ && (pose.position() - last_.position()).norm() < params_.distance)
      return geometry::Twist2{-params_.speed, 0.0};
    part_ = Part::turn;
    last_ = pose;
    until_ = now + patience(std::abs(turn_) / params_.turn_rate);
  }
  if (part_ == Part::none) return std::nullopt;
  const double left = turn_ > 0.0 ? 1.0 : -1.0;
  turn_ -= geometry::angle_between(last_.yaw, pose.yaw);
  last_ = pose;
  if (now < until_ && turn_ * left > 0.0) return geometry::Twist2{0.0, left * params_.turn_rate};
  part_ = Part::none;
  return std::nullopt;
}

}  // namespace kervan::exploration
