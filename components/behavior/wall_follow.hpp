/// Keeps a wall at a distance beside the robot.
#pragma once

#include <optional>

#include "components/behavior/situation.hpp"

namespace kervan::behavior {

/// How the robot turns while it follows a wall.
enum class FollowLaw {
  paper,         ///< fixed steps: straight on, or 1 degree a round to either side
  proportional,  ///< to the angle between robot and wall, and to the error of the distance
};

/// Distances are readings of the transducers that look to the side. The defaults of `near`, `far`, `lost`, `parallel`
/// and `step_turn` are those of Parlaktuna and Eroglu, "Gezgin robotlarda ultrasonik mesafe algilayicilarla robot
/// davranislarinin kontrolu ve cevre haritalama": 350, 450 and 1000 mm, 5 mm, 1 degree. They print neither speed nor
/// gains nor the rate of the steps, 10 Hz here.
struct WallFollowParams {
  FollowLaw law = FollowLaw::proportional;
  double speed = 0.2;       ///< m/s
  double near = 0.35;       ///< m, the inner edge of the band
  double far = 0.45;        ///< m, the outer one
  double lost = 1.0;        ///< m; a wall farther away is none
  double parallel = 0.005;  ///< m; `paper`: the robot is parallel when its two readings differ by no more
  double step_turn = geometry::radians(10.0);  ///< rad/s; `paper`: 1 degree every 100 ms
  double angle_gain = 1.2;                     ///< 1/s, turning rate for each radian between robot and wall
  double distance_gain = 1.5;                  ///< rad/s for each metre between the middle of the band and the wall
  double turn_rate = 0.5;                      ///< rad/s, the most
  Duration memory = std::chrono::seconds(2);   ///< a wall that is not heard any more is believed for so long
};

/// Wall following, paper's section on behaviours, with r7 and r8 the readings to the right before and behind the
/// wheels, s their spacing, and r the distance. `paper`: inside the band straight on if |r7 - r8| <= `parallel`, else
/// a step to the right for r7 > r8 and to the left for r7 < r8; too near, a step to the left; too far, to the right in
/// proportion to the error. `proportional`, throughout: omega = -angle_gain * atan((r7 - r8) / s) - distance_gain *
/// (r - (near + far) / 2), limited to ± turn_rate, r the mean of both. The paper's deadband of 5 mm is smaller than the
/// noise of the difference, so its law wanders.
///
/// If one reading alone has the wall, or their difference is none that a wall could make, the distance alone counts,
/// by the nearer one.
class WallFollow {
 public:
  using Params = WallFollowParams;
  explicit WallFollow(const Params& params) : params_(params) {}
  void set_params(const Params& params) { params_ = params; }

  Wish step(const Situation& situation);

 private:
  double turn_by_paper(const SonarView& view) const;
  double turn_in_proportion(const SonarView& view) const;
  double limited(double turn) const;

  Params params_;
  std::optional<Time> heard_;  // when the wall was last
};

}  // namespace kervan::behavior
