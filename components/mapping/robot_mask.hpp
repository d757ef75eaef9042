/// Leaves out of a scan what belongs to other robots, which a map is not to keep.
#pragma once

#include <span>

#include "framework/geometry/pose2.hpp"
#include "framework/geometry/scan.hpp"

namespace kervan::mapping {

/// Makes -infinity, which says nothing of a map, of every range of `scan` that ends within `radius`, m, of one of
/// `robots`. They and `laser` in one frame, m; what is not finite is nowhere. `ranges`: those of the scan, to be
/// changed; as many as it has.
void mask_robots(const geometry::Pose2& laser, const geometry::Scan& scan, std::span<const geometry::Vector2> robots,
                 double radius, std::span<float> ranges);

}  // namespace kervan::mapping
