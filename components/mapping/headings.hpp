/// Directions from a table.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "framework/geometry/pose2.hpp"

namespace kervan::mapping {

/// 256 directions evenly round the circle, 0 along x.
class Headings {
 public:
  static constexpr int count = 256;

  Headings() {
    for (int i = 0; i < count; ++i) {
      // Counted from -half to half a turn, so that sines and cosines of mirrored headings are equal but for the sign.
      const int turned = i > count / 2 ? i - count : i;
      axes_[static_cast<std::size_t>(i)] = geometry::heading(step * turned);
    }
  }

  /// Of length 1; `heading`: 0 .. count - 1.
  const geometry::Vector2& axis(int heading) const { return axes_[static_cast<std::size_t>(heading)]; }

  /// The heading that is nearest to `yaw`, at most 0.7 degrees away. |yaw| below 10^15.
  static int nearest(double yaw) { return static_cast<int>(steps(yaw) & (count - 1)); }

  /// (cos yaw, sin yaw) to the fourteenth digit, for yaws of a few turns (fewer digits for more), in a third of the
  /// time: the nearest axis turned by the rest, whose series end soon.
  geometry::Vector2 direction(double yaw) const {
    const std::int64_t whole = steps(yaw);
    const geometry::Vector2& axis = axes_[static_cast<std::size_t>(whole & (count - 1))];
    const double rest = yaw - step * static_cast<double>(whole), r2 = rest * rest;
    const double c = 1.0 - r2 / 2.0 * (1.0 - r2 / 12.0 * (1.0 - r2 / 30.0));
    const double s = rest * (1.0 - r2 / 6.0 * (1.0 - r2 / 20.0));
    return {axis.x() * c - axis.y() * s, axis.x() * s + axis.y() * c};
  }

 private:
  static constexpr double step = 2.0 * std::numbers::pi / count;  // rad
  static_assert((count & (count - 1)) == 0);

  /// The nearest whole number of steps; halves go up.
  static std::int64_t steps(double yaw) {
    const double nearest = yaw * (1.0 / step) + 0.5;
    const auto whole = static_cast<std::int64_t>(nearest);
    return whole - (nearest < static_cast<double>(whole) ? 1 : 0);
  }

  std::array<geometry::Vector2, count> axes_;
};

}  // namespace kervan::mapping
