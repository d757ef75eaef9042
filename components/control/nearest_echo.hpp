/// The obstacle point that a ring of sonars sees nearest to the robot.
#pragma once

#include <optional>
#include <span>

#include "framework/geometry/pose2.hpp"

namespace kervan::control {

/// One reading of one transducer.
struct SonarEcho {
  geometry::Pose2 transducer;  ///< in base_link, x along the axis of the cone
  double range = 0.0;          ///< m from the transducer
};

/// The echo nearest to the origin of base_link, as a point of base_link: a sonar does not say where in its cone the
/// echo came from, so the point is put on the axis. Readings beyond `max_range`, NaN or infinite ones are no echo; a
/// negative one counts as 0. None if there is no echo; of two equally near ones the first.
std::optional<geometry::Vector2> nearest_echo(std::span<const SonarEcho> echoes, double max_range);

}  // namespace kervan::control
