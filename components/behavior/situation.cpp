#include "components/behavior/situation.hpp"

namespace kervan::behavior {

Situation mirrored(const Situation& situation) {
  Situation result = situation;
  result.ring = mirrored(situation.ring);
  result.pose.y = -situation.pose.y;
  result.pose.yaw = -situation.pose.yaw;
  result.speed.angular = -situation.speed.angular;
  for (auto& point : result.pressed) point.y() = -point.y();
  for (auto& point : result.felt) point.y() = -point.y();
  result.stall = {situation.stall.right, situation.stall.left};
  return result;
}

Wish mirrored(const Wish& wish) { return {wish.active, {wish.twist.linear, -wish.twist.angular}, wish.why}; }

}  // namespace kervan::behavior
