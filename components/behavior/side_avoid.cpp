#include "components/behavior/side_avoid.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::behavior {

Wish SideAvoid::step(const Situation& situation) {
  const SonarView view = situation.view();
  const bool left = std::min(view.left_front(), view.left_rear()) < params_.distance;
  const bool right = view.beside() < params_.distance;
  if (!left && !right) {
    near_ = false;
    return no_wish("both sides are free");
  }
  if (!near_) turned_.start(situation.pose.yaw);
  near_ = true;
  const bool enough = std::abs(turned_.add(situation.pose.yaw)) >= params_.most_turn;
  if (left && right) return {true, {params_.speed, 0.0}, "both sides are near: straight on"};
  const bool tail = left ? view.left_rear() < view.left_front() : view.right_rear() < view.right_front();
  const double turn = tail || enough ? 0.0 : left ? -params_.turn_rate : params_.turn_rate;
  return {true, {params_.speed, turn}, left ? "the left side is near" : "the right side is near"};
}

}  // namespace kervan::behavior
