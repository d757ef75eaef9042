/// Goes round a corner that points towards the robot, or round the end of a wall.
#pragma once

#include <optional>

#include "components/behavior/situation.hpp"

namespace kervan::behavior {

/// Distances are readings of the transducers. `open` is the paper's 500 mm; it prints neither speed nor radius.
struct ConvexCornerParams {
  double open = 0.5;     ///< m; front and right are free beyond it, and the wall that ended is nearer behind
  double found = 0.65;   ///< m; a wall beside the robot within this distance is the one it has been looking for
  double ahead = 0.4;    ///< m; something ahead within this distance is a matter of the concave corner
  double speed = 0.2;    ///< m/s
  double radius = 0.62;  ///< m, of the arc round the corner
  double give_up = geometry::radians(216.0);  ///< rad; after 216 degrees without a wall there is none
  Duration memory = std::chrono::seconds(2);  ///< a wall lost within this time has ended here
};

/// Convex corner, paper's table of behaviours: front (-30..30) free, right (-100..0) free, but something behind on the
/// right (-180..-90): the wall has ended, turn round its end by up to 180 degrees until a wall is beside the robot.
///
/// Of the two transducers that look to -90 degrees, 7 belongs to the right and 8 to the rear: in the paper's sectors 8
/// is in both, so that they contradict each other. A wall that was beside the robot within the last two seconds and is
/// gone has ended too, whatever is heard behind: a sonar does not hear every surface at every angle. After 216 degrees
/// it gives up, until a wall has been found.
class ConvexCorner {
 public:
  using Params = ConvexCornerParams;
  explicit ConvexCorner(const Params& params) : params_(params) {}
  void set_params(const Params& params) { params_ = params; }

  Wish step(const Situation& situation);

 private:
  bool ended(const Situation& situation, const SonarView& view) const;

  Params params_;
  std::optional<Time> beside_;  // when a wall last was
  bool turning_ = false;
  bool given_up_ = false;
  TurnedAngle turned_;
};

}  // namespace kervan::behavior
