#include "components/behavior/wall_find.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kervan::behavior {
namespace {

constexpr double carried_off = 0.25;  // m
constexpr double most_alignment = geometry::radians(130.0);
constexpr double agreement = 0.005;                  // m between two readings of a parallel wall
constexpr double bearing_gain = 1.5;                 // 1/s
constexpr double on_course = geometry::radians(15);  // it drives only towards where it looks
constexpr double overshoot = 0.5;                    // m beyond the place where the wall was heard

}  // namespace

void WallFind::enter(Phase phase, const Situation& situation) {
  phase_ = phase;
  entered_ = situation.pose.position();
  turned_.start(situation.pose.yaw);
  if (phase != Phase::look) return;
  noted_ = -params_.sector;
  nearest_ = nothing;
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
  if (turned >= noted_ + params_.sector) {
    noted_ = turned;
    const double ahead = std::min(view.heard(3), view.heard(4));
    if (ahead < nearest_) {
      nearest_ = ahead;
      bearing_ = situation.pose.yaw;
    }
  }
  if (turned < 2.0 * std::numbers::pi) return {true, {0.0, params_.turn_rate}, "looking around for a wall"};
  if (nearest_ == nothing) {
    bearing_ = in_vain_ == 0 ? situation.pose.yaw : bearing_ + geometry::radians(90.0);
    way_ = params_.onwards * (1 + in_vain_ / 2);
    ++in_vain_;
  } else {
    way_ = nearest_ + overshoot;
    in_vain_ = 0;
  }
  enter(Phase::drive, situation);
  return drive(situation, view);
}

Wish WallFind::drive(const Situation& situation, const SonarView& view) {
  const double room = view.front() - params_.stop;
  if (room <= 0.0 || view.beside() < params_.stop) {
    enter(Phase::align, situation);
    return align(situation, view);
  }
  if ((situation.pose.position() - entered_).norm() > way_) {
    phase_ = Phase::idle;
    return step(situation);
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
    return no_wish("the wall is found");
  }
  return {true, {0.0, params_.turn_rate}, "turning the wall to the side"};
}

}  // namespace kervan::behavior
