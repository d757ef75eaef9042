#include "components/behavior/wall_follow.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::behavior {

namespace {
constexpr double steepest = geometry::radians(45.0);  // a wall at a larger angle to the robot is two different things
}

double WallFollow::limited(double turn) const { return std::clamp(turn, -params_.turn_rate, params_.turn_rate); }

double WallFollow::turn_by_paper(const SonarView& view) const {
  const double r = view.beside();
  if (r < params_.near) return params_.step_turn;
  if (r > params_.far) return limited(-params_.distance_gain * (r - 0.5 * (params_.near + params_.far)));
  const double difference = view.right_front() - view.right_rear();
  if (std::abs(difference) <= params_.parallel) return 0.0;
  return std::copysign(params_.step_turn, -difference);
}

double WallFollow::turn_in_proportion(const SonarView& view) const {
  const double middle = 0.5 * (params_.near + params_.far);
  const double r7 = view.right_front(), r8 = view.right_rear();
  if (r7 < params_.lost && r8 < params_.lost) {
    const double angle = std::atan2(r7 - r8, view.spacing());
    if (std::abs(angle) <= steepest)
      return limited(-params_.angle_gain * angle - params_.distance_gain * (0.5 * (r7 + r8) - middle));
  }
  return limited(-params_.distance_gain * (view.beside() - middle));
}

Wish WallFollow::step(const Situation& situation) {
  const SonarView view = situation.view();
  if (view.beside() < params_.lost) {
    heard_ = situation.now;
    const double turn = params_.law == FollowLaw::paper ? turn_by_paper(view) : turn_in_proportion(view);
    return {true, {params_.speed, turn}, "a wall is beside the robot"};
  }
  if (heard_ && situation.now - *heard_ <= params_.memory)
    return {true, {params_.speed, 0.0}, "the wall beside the robot is remembered"};
  heard_.reset();
  return no_wish("no wall is beside the robot");
}

}  // namespace kervan::behavior
