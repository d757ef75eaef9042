/// Turns away from what is ahead: the concave corner of a wall that is followed.
#pragma once

#include "components/behavior/situation.hpp"

namespace kervan::behavior {

/// `distance` is the paper's 400 mm, a reading of the transducers, `turn` its 90 degrees.
struct FrontAvoidParams {
  double distance = 0.4;                  ///< m; something nearer ahead, -30..30 degrees, is too near
  double turn = geometry::radians(90.0);  ///< rad
  double turn_rate = 0.5;                 ///< rad/s
};

/// Front avoidance, paper's table of behaviours: something ahead nearer than `distance`, turn by 90 degrees. The paper
/// does not say where to; the wall is on the right, so the turn is to the left. On the spot, and on beyond 90 degrees
/// while the way is not free.
class FrontAvoid {
 public:
  using Params = FrontAvoidParams;
  explicit FrontAvoid(const Params& params) : params_(params) {}
  void set_params(const Params& params) { params_ = params; }

  Wish step(const Situation& situation);

 private:
  Params params_;
  bool turning_ = false;
  TurnedAngle turned_;
};

}  // namespace kervan::behavior
