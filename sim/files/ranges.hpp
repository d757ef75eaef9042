/// Quantities of world and robot files that must lie in a range.
#pragma once

#include <string>
#include <string_view>

#include "framework/config/node.hpp"
#include "sim/shapes.hpp"

namespace kervan::sim {

/// Metres from the origin of map. Far more than any building, and near enough for exact micrometres.
inline constexpr double farthest = 1e6;

/// A number as messages show it: `1000000`, `0.65`.
std::string text_of(double number);

/// The quantity in SI units, or ConfigError at the node if it is not positive or above `highest`.
double positive(const config::Node& node, std::string_view unit, double highest);

/// The same for what may also be 0.
double not_negative(const config::Node& node, std::string_view unit, double highest);

/// A point of map, or ConfigError at the coordinate that is farther than `limit` from the origin.
Vector2 point_within(const config::Node& node, double limit);

/// The same for a pose.
Pose2 pose_within(const config::Node& node, double limit);

/// The file must say in which version of its format it is written, and 1 is the only one: `kervan_world: 1`.
void require_version_1(const config::Node& file, std::string_view key);

}  // namespace kervan::sim
