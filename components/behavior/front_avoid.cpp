#include "components/behavior/front_avoid.hpp"

namespace kervan::behavior {

Wish FrontAvoid::step(const Situation& situation) {
  const bool blocked = situation.view().front() < params_.distance;
  if (turning_) {
    turning_ = turned_.add(situation.pose.yaw) < params_.turn || blocked;
  } else if (blocked) {
    turning_ = true;
    turned_.start(situation.pose.yaw);
  }
  if (!turning_) return no_wish("the way ahead is free");
  return {true, {0.0, params_.turn_rate}, blocked ? "something is ahead: turn away" : "turn on along what was ahead"};
}

}  // namespace kervan::behavior
