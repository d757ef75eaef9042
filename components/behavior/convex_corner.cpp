#include "components/behavior/convex_corner.hpp"

namespace kervan::behavior {

bool ConvexCorner::ended(const Situation& situation, const SonarView& view) const {
  if (!(view.front() > params_.open && view.right() > params_.open)) return false;
  const bool remembered = beside_ && situation.now - *beside_ <= params_.memory;
  return view.rear_right() < params_.open || remembered;
}

Wish ConvexCorner::step(const Situation& situation) {
  const SonarView view = situation.view();
  if (view.right_front() < params_.found) {
    beside_ = situation.now;
    turning_ = given_up_ = false;
    return no_wish("a wall is beside the robot");
  }
  if (turning_) {
    if (view.front() < params_.ahead) {
      turning_ = false;
      return no_wish("something is ahead");
    }
    if (turned_.add(situation.pose.yaw) < -params_.give_up) {
      turning_ = false;
      given_up_ = true;
      beside_.reset();
    }
  } else if (!given_up_ && ended(situation, view)) {
    turning_ = true;
    turned_.start(situation.pose.yaw);
  }
  if (given_up_) return no_wish("there was no wall behind the corner");
  if (!turning_) return no_wish("no wall has ended here");
  return {true, {params_.speed, -params_.speed / params_.radius}, "the wall has ended: round its corner"};
}

}  // namespace kervan::behavior
