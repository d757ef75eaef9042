#include "components/behavior/side_avoid.hpp"

#include <algorithm>

namespace kervan::behavior {

Wish SideAvoid::step(const Situation& situation) const {
  const SonarView view = situation.view();
  const bool left = std::min(view.left_front(), view.left_rear()) < params_.distance;
  const bool right = view.beside() < params_.distance;
  if (!left && !right) return no_wish("both sides are free");
  if (left && right) return {true, {params_.speed, 0.0}, "both sides are near: straight on"};
  if (left) {
    const bool tail = view.left_rear() < view.left_front();
    return {true, {params_.speed, tail ? 0.0 : -params_.turn_rate}, "the left side is near"};
  }
  const bool tail = view.right_rear() < view.right_front();
  return {true, {params_.speed, tail ? 0.0 : params_.turn_rate}, "the right side is near"};
}

}  // namespace kervan::behavior
