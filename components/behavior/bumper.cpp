#include "components/behavior/bumper.hpp"

#include <algorithm>

namespace kervan::behavior {

Wish Bumper::step(const Situation& situation) {
  const auto& pressed = situation.pressed;
  if (!pressed.empty()) {
    const auto at_front = [](const geometry::Vector2& point) { return point.x() >= 0.0; };
    const bool front = std::any_of(pressed.begin(), pressed.end(), at_front);
    const bool rear = !std::all_of(pressed.begin(), pressed.end(), at_front);
    if (front && rear) {
      direction_.reset();
      return {true, {}, "pressed at both ends"};
    }
    direction_ = front ? -1.0 : 1.0;
    released_ = situation.now;
    from_ = situation.pose.position();
  } else if (direction_) {
    const bool away = (situation.pose.position() - from_).norm() >= params_.distance;
    if (away || situation.now - released_ > params_.patience) direction_.reset();
  }
  if (!direction_) return no_wish("no bumper is pressed");
  return {true, {*direction_ * params_.speed, 0.0}, *direction_ > 0.0 ? "bumped at the rear" : "bumped at the front"};
}

}  // namespace kervan::behavior
