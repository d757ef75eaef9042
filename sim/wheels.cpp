#include "sim/wheels.hpp"

namespace kervan::sim {

namespace {
constexpr double rounding = 1e-9;  // m in a step; what a sum of small movements may lack
}

Stall stalled(const Twist2& target, const Motion& wanted, const Motion& done, double track) {
  const WheelTravel told = wheel_travel({target.linear, target.angular}, track);
  const WheelTravel missing = wheel_travel({wanted.distance - done.distance, wanted.turn - done.turn}, track);
  const auto lacks = [](double direction, double travel) {
    return direction > 0.0 ? travel > rounding : direction < 0.0 && travel < -rounding;
  };
  return {lacks(told.left, missing.left), lacks(told.right, missing.right)};
}

}  // namespace kervan::sim
