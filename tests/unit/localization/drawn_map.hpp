/// A map drawn by a test: free but for the walls.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "components/localization/point_map.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::localization {

class DrawnMap {
 public:
  /// Known to be free from (-side, -side) to (side, side), m; unknown beyond.
  explicit DrawnMap(double side) {
    for (double y = -side + 0.5 * resolution; y < side; y += resolution)
      map_.add({-side + 0.5 * resolution, y}, {side + 0.5 * resolution, y});
  }

  /// Many echoes from all along the line.
  DrawnMap& wall(const geometry::Vector2& from, const geometry::Vector2& to, int echoes = 5) {
    const int steps = 1 + static_cast<int>((to - from).norm() / (0.2 * resolution));
    for (int i = 0; i <= steps; ++i) {
      const geometry::Vector2 at = from + (to - from) * (static_cast<double>(i) / steps);
      for (int k = 0; k < echoes; ++k) map_.add(at, at);
    }
    return *this;
  }

  operator const PointMap&() const { return map_; }

  static constexpr double resolution = 0.05;

 private:
  PointMap map_{resolution, std::size_t{1} << 26};
};

/// The distance along a ray to the nearest of some segments; infinity if it meets none.
inline double ray(const geometry::Vector2& from, double yaw,
                  std::span<const std::pair<geometry::Vector2, geometry::Vector2>> walls) {
  double nearest = std::numeric_limits<double>::infinity();
  const geometry::Vector2 d = geometry::heading(yaw);
  for (const auto& [a, b] : walls) {
    const geometry::Vector2 e = b - a, to = a - from;
    const double cross = d.x() * e.y() - d.y() * e.x();
    if (std::abs(cross) < 1e-12) continue;
    const double t = (to.x() * e.y() - to.y() * e.x()) / cross, u = (to.x() * d.y() - to.y() * d.x()) / cross;
    if (t >= 0.0 && u >= 0.0 && u <= 1.0) nearest = std::min(nearest, t);
  }
  return nearest;
}

}  // namespace kervan::localization
