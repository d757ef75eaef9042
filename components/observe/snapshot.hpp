/// What a robot's sensors saw at one time, as areas for a drawing. Metres and radians, in the map frame.
#pragma once

#include <span>
#include <vector>

#include "components/observe/polyline.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::observe {

struct Snapshot {
  double time = 0.0;           ///< seconds since the run began
  geometry::Pose2 pose;        ///< of base_link, the truth
  std::vector<Polyline> seen;  ///< areas that the sensors found empty, their last corner joined to the first
};

/// What a sonar found empty that heard an echo at `range`: from the transducer, which looks along the x axis of its
/// pose, to the arc at that distance. Empty if the range is not finite and positive.
Polyline cone(const geometry::Pose2& transducer, double field_of_view, double range);

/// What a laser found empty, which looks along the x axis of its pose: from it to where each beam ended, the first at
/// `first_angle` and each next one `increment` further to the left. A beam without an echo (a range that is not finite
/// or not positive) ends an area; one beam alone is none.
std::vector<Polyline> sweep(const geometry::Pose2& laser, double first_angle, double increment,
                            std::span<const float> ranges);

/// Where a body that is at `pose` now was `time` seconds ago (later, if negative), had its speed always been `speed`.
geometry::Pose2 moved_back(const geometry::Pose2& pose, const geometry::Twist2& speed, double time);

}  // namespace kervan::observe
