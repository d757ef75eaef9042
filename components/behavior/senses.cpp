#include "components/behavior/senses.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::behavior {

namespace {
constexpr double moves = 0.01;  // m/s
}

std::string Senses::hear(std::span<const SonarReading> readings, double max_range, Time now) {
  std::string why = misfit(readings);
  if (!why.empty()) {
    ++refused_;
    return why;
  }
  absurd_ = false;
  for (std::size_t i = 0; i < ring_size; ++i) {
    const double range = readings[i].range;
    last_.ring[i].transducer = readings[i].transducer;
    if (range >= 0.0) {
      last_.ring[i].range = range > max_range ? nothing : range;
      fired_[i] = now;
    } else if (!std::isnan(range)) {
      ++refused_;
      absurd_ = true;
    }
  }
  heard_ = true;
  return {};
}

bool Senses::move(const geometry::Pose2& pose, const geometry::Twist2& speed) {
  if (!pose.position().allFinite() || !std::isfinite(pose.yaw) || !std::isfinite(speed.linear) ||
      !std::isfinite(speed.angular)) {
    ++refused_;
    return false;
  }
  last_.pose = pose;
  last_.speed = speed;
  if (std::abs(speed.linear) > moves) direction_ = std::copysign(1.0, speed.linear);
  moved_ = true;
  return true;
}

void Senses::press(std::span<const geometry::Vector2> pressed, Time now) {
  last_.pressed.clear();
  for (const geometry::Vector2& point : pressed) {
    if (!point.allFinite()) {
      ++refused_;
      continue;
    }
    last_.pressed.push_back(point);
    if (moved_) felt_.add(last_.pose * point, now);
  }
}

void Senses::stall(const Stall& stall, Time now) {
  last_.stall = stall;
  if (!stall.any() || !moved_) return;
  const double y = stall.left == stall.right ? 0.0 : stall.left ? params_.half_width : -params_.half_width;
  felt_.add(last_.pose * geometry::Vector2(direction_ > 0.0 ? params_.nose : -params_.tail, y), now);
}

Situation Senses::at(Time now) {
  last_.now = now;
  for (std::size_t i = 0; i < ring_size; ++i)
    if (now - fired_[i] > params_.oldest) last_.ring[i].range = nothing;
  last_.felt = felt_.seen_from(last_.pose, now);
  return params_.side == Side::left ? mirrored(last_) : last_;
}

}  // namespace kervan::behavior
