/// Turns away from what is too near beside the robot.
#pragma once

#include "components/behavior/situation.hpp"

namespace kervan::behavior {

/// `distance` is the paper's 200 mm, a reading of the transducers, `turn_rate` its 5 degrees a round of 100 ms.
struct SideAvoidParams {
  double distance = 0.2;                       ///< m
  double turn_rate = geometry::radians(50.0);  ///< rad/s
  double most_turn = geometry::radians(10.0);  ///< rad; then straight on until the side is free
  double speed = 0.1;                          ///< m/s
};

/// Side avoidance, paper's table of behaviours: left (right) nearer than 200 mm, 5 degrees to the right (left). Where
/// the transducer behind the wheels is the nearer one of a side, the robot points away already and would swing its tail
/// into the obstacle: it drives straight on. So it does with both sides too near, and once it has turned by
/// `most_turn`: an obstacle that ends beside the robot, or reflects the sonar away, may still have the tail before it.
class SideAvoid {
 public:
  using Params = SideAvoidParams;
  explicit SideAvoid(const Params& params) : params_(params) {}
  void set_params(const Params& params) { params_ = params; }

  Wish step(const Situation& situation);

 private:
  Params params_;
  bool near_ = false;
  TurnedAngle turned_;  // since a side has been near
};

}  // namespace kervan::behavior
