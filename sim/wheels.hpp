/// The wheels under a base: how far each side rolls when the base moves, and which of them an obstacle stops.
#pragma once

#include "sim/drive.hpp"

namespace kervan::sim {

/// How far the wheels of either side roll, m; negative backwards. All wheels of a synchro drive roll alike.
struct WheelTravel {
  double left = 0.0;
  double right = 0.0;
};

/// What the wheels do when the base moves so. `track` is the distance between left and right wheels, m; 0 stands for a
/// synchro drive, whose wheels are steered and do not roll when base_link turns.
inline WheelTravel wheel_travel(const Motion& motion, double track) {
  return {motion.distance - 0.5 * track * motion.turn, motion.distance + 0.5 * track * motion.turn};
}

/// Which wheels turn less than they are told to.
struct Stall {
  bool left = false;
  bool right = false;

  bool operator==(const Stall&) const = default;
};

/// The wheels that rolled less far than the drive would have turned them, in the direction of the drive's `target`: it
/// `wanted` one movement and an obstacle left of it what was `done`. A wheel that is not told to turn does not stall,
/// be the base in contact or not, nor does one that an obstacle does not hinder.
Stall stalled(const Twist2& target, const Motion& wanted, const Motion& done, double track);

}  // namespace kervan::sim
