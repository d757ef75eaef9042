#include "components/control/nearest_echo.hpp"

#include <algorithm>

namespace kervan::control {

std::optional<geometry::Vector2> nearest_echo(std::span<const SonarEcho> echoes, double max_range) {
  std::optional<geometry::Vector2> nearest;
  for (const auto& echo : echoes) {
    if (!(echo.range <= max_range)) continue;  // also drops NaN
    const geometry::Vector2 point = echo.transducer * geometry::Vector2(std::max(0.0, echo.range), 0.0);
    if (!nearest || point.norm() < nearest->norm()) nearest = point;
  }
  return nearest;
}

}  // namespace kervan::control
