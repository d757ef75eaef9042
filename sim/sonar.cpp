#include "sim/sonar.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <stdexcept>

namespace kervan::sim {

Sonars::Sonars(const SonarRing& ring, const SonarSettings& settings) : ring_(ring), settings_(settings) {
  if (settings.rays < 1) throw std::invalid_argument("a sonar needs at least 1 ray");
  if (!(settings.noise >= 0.0)) throw std::invalid_argument("the noise of the sonars must not be negative");
  if (!(settings.drop_out >= 0.0 && settings.drop_out <= 1.0))
    throw std::invalid_argument("the drop-out probability of the sonars must be in [0, 1]");
  if (settings.incidence_limit) min_cosine_ = std::cos(*settings.incidence_limit);

  // Each ray stands in the middle of an equal share of the cone: 32 rays in 30 degrees end at 14.53 degrees.
  const double share = ring.field_of_view / settings.rays;
  for (const Pose2& pose : ring.poses) {
    for (int i = 0; i < settings.rays; ++i)
      directions_.push_back(geometry::heading(pose.yaw - 0.5 * ring.field_of_view + (i + 0.5) * share));
  }
}

void Sonars::measure(const Surroundings& around, const Pose2& pose, const RandomSource& random, std::uint64_t scan,
                     std::span<double> ranges) const {
  assert(ranges.size() == size());
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  const auto rays = static_cast<std::size_t>(settings_.rays);
  for (std::size_t i = 0; i < size(); ++i) {
    double range = echo(around, pose * ring_.poses[i].position(), {&directions_[i * rays], rays}, c, s);
    // Both numbers are drawn always, so that one imperfection does not change what the other does.
    auto sequence = random.at(RandomUse::sonar, static_cast<std::uint16_t>(i), scan);
    const bool dropped = sequence.uniform() < settings_.drop_out;
    const double noisy = range * (1.0 + settings_.noise * sequence.gaussian());
    range = dropped || !(noisy <= ring_.max_range) ? infinity : std::max(noisy, ring_.min_range);
    ranges[i] = range;
  }
}

double Sonars::echo(const Surroundings& around, const Vector2& origin, std::span<const Vector2> directions, double c,
                    double s) const {
  constexpr std::size_t most = 64;  // rays at a time, on the stack
  std::array<Vector2, most> turned;
  std::array<RayHit, most> hits;
  double nearest = infinity;
  for (std::size_t first = 0; first < directions.size(); first += most) {
    const std::size_t count = std::min(most, directions.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Vector2& d = directions[first + i];
      turned[i] = {c * d.x() - s * d.y(), s * d.x() + c * d.y()};
    }
    around.cast(origin, {turned.data(), count}, ring_.max_range, {hits.data(), count});
    for (std::size_t i = 0; i < count; ++i) {
      const RayHit& hit = hits[i];
      if (hit.distance >= nearest) continue;
      if (settings_.incidence_limit && -turned[i].dot(hit.normal) < min_cosine_) continue;
      nearest = hit.distance;
    }
  }
  return nearest;
}

}  // namespace kervan::sim
