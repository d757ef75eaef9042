#include "components/exploration/target_draw.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kervan::exploration {
namespace {

using geometry::Vector2;

constexpr std::uint64_t most_tries = 10'000;

double distance_to_line(const Vector2& point, const Vector2& a, const Vector2& b) {
  const Vector2 along = b - a;
  const double length = along.squaredNorm();
  const double t = length > 0.0 ? std::clamp(along.dot(point - a) / length, 0.0, 1.0) : 0.0;
  return (a + t * along - point).norm();
}

/// Counts how often a ray to the right leaves or enters (Shimrat 1962, doi:10.1145/368637.368653).
bool inside(const Vector2& point, const std::vector<Vector2>& corners) {
  bool in = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Vector2 &a = corners[i], &b = corners[j];
    if ((a.y() > point.y()) != (b.y() > point.y()) &&
        point.x() < (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y()) + a.x())
      in = !in;
  }
  return in;
}

std::uint64_t mixed(std::uint64_t z) {
  z += 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

}  // namespace

double uniform(std::uint64_t seed, std::uint64_t k, std::uint64_t j) {
  return static_cast<double>(mixed(mixed(mixed(seed) ^ k) ^ j) >> 11) * 0x1p-53;
}

double Obstacles::distance(const Vector2& point) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Wall& wall : walls) least = std::min(least, distance_to_line(point, wall.a, wall.b));
  for (const Circle& circle : circles)
    least = std::min(least, std::max(0.0, (circle.center - point).norm() - circle.radius));
  for (const auto& corners : polygons) {
    if (corners.empty()) continue;
    if (inside(point, corners)) return 0.0;
    for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++)
      least = std::min(least, distance_to_line(point, corners[j], corners[i]));
  }
  return least;
}

std::optional<Area> area_around(const Obstacles& obstacles) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Area area{{inf, inf}, {-inf, -inf}};
  const auto add = [&area](const Vector2& point, double radius) {
    area.low = area.low.cwiseMin(point - Vector2(radius, radius));
    area.high = area.high.cwiseMax(point + Vector2(radius, radius));
  };
  for (const auto& wall : obstacles.walls) {
    add(wall.a, 0.0);
    add(wall.b, 0.0);
  }
  for (const auto& circle : obstacles.circles) add(circle.center, circle.radius);
  for (const auto& corners : obstacles.polygons)
    for (const Vector2& corner : corners) add(corner, 0.0);
  return area.low.allFinite() ? std::optional(area) : std::nullopt;
}

std::optional<Vector2> draw_target(std::uint64_t seed, std::uint64_t k, const Area& area, const Obstacles& obstacles,
                                   double room) {
  const Vector2 size = area.high - area.low;
  for (std::uint64_t j = 0; j < most_tries; ++j) {
    const Vector2 place = area.low + size.cwiseProduct(Vector2(uniform(seed, k, 2 * j), uniform(seed, k, 2 * j + 1)));
    if (obstacles.distance(place) >= room) return place;
  }
  return std::nullopt;
}

}  // namespace kervan::exploration
