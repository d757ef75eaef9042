#include "components/behavior/sonar_view.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::behavior {
namespace {

/// Where the transducers of a Pioneer look, degrees (AriaCoda, params/p3dx.p and p3at-sh.p).
constexpr std::array<double, ring_size> directions{90.0,  50.0,   30.0,   10.0,   -10.0, -30.0, -50.0, -90.0,
                                                   -90.0, -130.0, -150.0, -170.0, 170.0, 150.0, 130.0, 90.0};
constexpr double fit = geometry::radians(5.0);

}  // namespace

std::string misfit(std::span<const SonarReading> readings) {
  if (readings.size() != ring_size)
    return std::to_string(readings.size()) + " readings, but the ring of a Pioneer has " + std::to_string(ring_size);
  for (std::size_t i = 0; i < ring_size; ++i) {
    const geometry::Pose2& at = readings[i].transducer;
    const bool fits =
        at.position().allFinite() && std::abs(geometry::angle_between(geometry::radians(directions[i]), at.yaw)) <= fit;
    if (!fits)
      return "transducer " + std::to_string(i) + " does not look to " +
             std::to_string(static_cast<int>(directions[i])) + " degrees, as that of a Pioneer does";
  }
  if (!(readings[7].transducer.x > readings[8].transducer.x)) return "transducer 7 does not stand before transducer 8";
  return {};
}

SonarRing mirrored(const SonarRing& ring) {
  SonarRing result;
  for (std::size_t i = 0; i < ring_size; ++i) {
    const SonarReading& other = ring[i < 8 ? 7 - i : 23 - i];
    result[i] = {{other.transducer.x, -other.transducer.y, -other.transducer.yaw}, other.range};
  }
  return result;
}

SonarView::SonarView(const SonarRing& ring, std::span<const geometry::Vector2> felt, double field_of_view)
    : ring_(ring) {
  for (std::size_t i = 0; i < ring_size; ++i) ranges_[i] = ring[i].range;
  for (const geometry::Vector2& point : felt) feel(point, field_of_view);
}

void SonarView::feel(const geometry::Vector2& point, double field_of_view) {
  std::size_t nearest = 0;
  double least_angle = nothing;
  for (std::size_t i = 0; i < ring_size; ++i) {
    const geometry::Vector2 seen = ring_[i].transducer.inverse() * point;
    const double angle = std::abs(std::atan2(seen.y(), seen.x()));
    if (angle <= 0.5 * field_of_view) ranges_[i] = std::min(ranges_[i], seen.norm());
    if (angle >= least_angle) continue;
    least_angle = angle;
    nearest = i;
  }
  const double distance = (point - ring_[nearest].transducer.position()).norm();
  ranges_[nearest] = std::min(ranges_[nearest], distance);
}

double SonarView::least(std::size_t first, std::size_t last) const {
  return *std::min_element(ranges_.begin() + static_cast<std::ptrdiff_t>(first),
                           ranges_.begin() + static_cast<std::ptrdiff_t>(last) + 1);
}

}  // namespace kervan::behavior
