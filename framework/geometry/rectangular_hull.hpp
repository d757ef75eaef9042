/// The outline of a robot as a rectangle.
#pragma once

#include <algorithm>
#include <cmath>

#include "framework/geometry/pose2.hpp"

namespace kervan::geometry {

/// A rectangle around the origin of base_link, m; all not negative.
struct RectangularHull {
  double front = 0.254;  ///< the defaults are a Jackal's
  double rear = 0.254;
  double half_width = 0.215;
};

/// m from the hull to a point of base_link; negative inside, as deep as the nearest side is away.
inline double clearance(const RectangularHull& hull, const Vector2& point) {
  const double ahead = std::max(point.x() - hull.front, -hull.rear - point.x());
  const double aside = std::abs(point.y()) - hull.half_width;
  if (ahead <= 0.0 && aside <= 0.0) return std::max(ahead, aside);
  return std::hypot(std::max(ahead, 0.0), std::max(aside, 0.0));
}

/// From the origin to its farthest corner, m.
inline double circumscribed_radius(const RectangularHull& hull) {
  return std::hypot(std::max(hull.front, hull.rear), hull.half_width);
}

}  // namespace kervan::geometry
