/// Angles in radians, counter-clockwise positive.
#pragma once

#include <cmath>
#include <numbers>

namespace kervan::geometry {

/// The same direction in (-pi, pi]. NaN stays NaN.
inline double wrap_angle(double angle) {
  constexpr double turn = 2.0 * std::numbers::pi;
  const double wrapped = std::remainder(angle, turn);  // [-pi, pi]
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

/// The shortest turn from `from` to `to`, in (-pi, pi].
inline double angle_between(double from, double to) { return wrap_angle(to - from); }

constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

}  // namespace kervan::geometry
