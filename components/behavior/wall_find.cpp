#include "components/behavior/wall_find.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kervan::behavior {
namespace {

constexpr double noise = 0.05;        // share by which two readings of the same thing differ
constexpr double carried_off = 0.25;  // m
constexpr double most_alignment = geometry::radians(130.0);
constexpr double agreement = 0.005;                  // m between two readings of a parallel wall
constexpr double bearing_gain = 1.5;                 // 1/s
constexpr double on_course = geometry::radians(15);  // it drives only towards where it looks

}  // namespace

void WallFind::enter(Phase phase, const Situation& situation) {
  phase_ = phase;
  entered_ = situation.pose.position();
  turned_.start(situation.pose.yaw);
  if (phase != Phase::look) return;
  noted_.clear();
}

std::optional<WallFind::Noted> WallFind::nearest() const {
  const auto closer = [](const Noted& a, const Noted& b) { return a.range < b.range; };
  const auto least = std::min_element(noted_.begin(), noted_.end(), closer);
  if (least == noted_.end() || least->range == nothing) return std::nullopt;
  // A cone hears the same nearest thing in many directions; the thing is in the middle of them.
  const auto count = noted_.size(), at = static_cast<std::size_t>(least - noted_.begin());
  const auto same = [&](std::size_t i) { return noted_[i % count].range <= least->range * (1.0 + noise); };
  std::size_t before = 0, after = 0;
  while (before + 1 < count && same(at + count - before - 1)) ++before;
  while (before + after + 1 < count && same(at + after + 1)) ++after;
  const double from = noted_[(at + count - before) % count].yaw, to = noted_[(at + after) % count].yaw;
  double arc = geometry::angle_between(from, to);
  if (arc < 0.0) arc += 2.0 * std::numbers::pi;
  return Noted{geometry::wrap_angle(from + 0.5 * arc), least->range};
}

Wish WallFind::step(const Situation& situation) {
  const SonarView view = situation.view();
  if (phase_ == Phase::idle) {
    if (view.beside() < params_.lost) return no_wish("a wall is beside the robot");
    enter(Phase::look, situation);
  }
  if (phase_ == Phase::look) return look(situation, view);
  if (phase_ == Phase::drive) return drive(situation, view);
  return align(situation, view);
}

Wish WallFind::look(const Situation& situation, const SonarView& view) {
  if ((situation.pose.position() - entered_).norm() > carried_off) {
    phase_ = Phase::idle;
    return step(situation);
  }
  const double turned = turned_.add(situation.pose.yaw);
  if (turned >= params_.sector * static_cast<double>(noted_.size()))
    noted_.push_back({situation.pose.yaw, std::min(view.heard(3), view.heard(4))});
  if (turned < 2.0 * std::numbers::pi) return {true, {0.0, params_.turn_rate}, "looking around for a wall"};
  const auto wall = nearest();
  if (!wall) {
    bearing_ = in_vain_ == 0 ? situation.pose.yaw : bearing_ + geometry::radians(90.0);
    way_ = params_.onwards * (1 + in_vain_ / 2);
    ++in_vain_;
  } else {
    bearing_ = wall->yaw;
    way_ = wall->range - params_.stop;
    in_vain_ = 0;
  }
  enter(Phase::drive, situation);
  return drive(situation, view);
}

Wish WallFind::drive(const Situation& situation, const SonarView& view) {
  const double room = view.front() - params_.stop;
  const bool driven = (situation.pose.position() - entered_).norm() > way_;
  if (driven && in_vain_ > 0) {
    phase_ = Phase::idle;
    return step(situation);
  }
  // Where the wall was heard it is, though it may not be heard from here.
  if (driven || room <= 0.0 || view.beside() < params_.stop) {
    enter(Phase::align, situation);
    return align(situation, view);
  }
  const double error = geometry::angle_between(situation.pose.yaw, bearing_);
  const double turn = std::clamp(bearing_gain * error, -params_.turn_rate, params_.turn_rate);
  const double speed = std::min(params_.speed, std::sqrt(2.0 * params_.braking * room));
  return {true, {std::abs(error) <= on_course ? std::max(speed, 0.02) : 0.0, turn}, "driving to the nearest wall"};
}

Wish WallFind::align(const Situation& situation, const SonarView& view) {
  const double turned = turned_.add(situation.pose.yaw);
  const bool beside = view.right_front() < params_.lost && view.right_rear() < params_.lost;
  const bool parallel = beside && view.right_front() >= view.right_rear() - agreement;
  if (parallel || turned >= most_alignment) {
    phase_ = Phase::idle;
    return step(situation);
  }
  return {true, {0.0, params_.turn_rate}, "turning the wall to the side"};
}

}  // namespace kervan::behavior
