#include "sim/sonar.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace kervan::sim {

namespace {
constexpr double any_cosine = -2.0;  // less than that of any angle, however it is rounded
}

Sonars::Sonars(const SonarRing& ring, const SonarSettings& settings)
    : ring_(ring),
      settings_(settings),
      min_cosine_(settings.incidence_limit ? std::cos(*settings.incidence_limit) : any_cosine) {
  if (settings.rays < 1) throw std::invalid_argument("a sonar needs at least 1 ray");
  if (!(settings.noise >= 0.0)) throw std::invalid_argument("the noise of the sonars must not be negative");
  if (!(settings.drop_out >= 0.0 && settings.drop_out <= 1.0))
    throw std::invalid_argument("the drop-out probability of the sonars must be in [0, 1]");
  if (!(settings.crosstalk >= 0.0 && settings.crosstalk <= 1.0))
    throw std::invalid_argument("the crosstalk probability of the sonars must be in [0, 1]");
  if (!(settings.incidence_drop_off >= 0.0 && settings.incidence_drop_off <= settings.incidence_limit.value_or(0.0)))
    throw std::invalid_argument("the incidence drop-off of the sonars must be between 0 and their incidence limit");

  // Each ray stands in the middle of an equal share of the cone: 32 rays in 30 degrees end at 14.53 degrees.
  const double share = ring.field_of_view / settings.rays;
  for (const Pose2& pose : ring.poses) {
    for (int i = 0; i < settings.rays; ++i)
      directions_.push_back(geometry::heading(pose.yaw - 0.5 * ring.field_of_view + (i + 0.5) * share));
  }
  if (ring_.arrays.empty() && !ring_.poses.empty()) {
    ring_.arrays.emplace_back(ring_.poses.size());
    std::iota(ring_.arrays[0].begin(), ring_.arrays[0].end(), std::uint16_t{0});
  }
}

std::size_t Sonars::firing() const { return settings_.firing == SonarFiring::all ? size() : ring_.arrays.size(); }

std::uint16_t Sonars::firing(std::size_t k, std::uint64_t round) const {
  if (settings_.firing == SonarFiring::all) return static_cast<std::uint16_t>(k);
  return ring_.arrays[k][round % ring_.arrays[k].size()];
}

void Sonars::measure(const Surroundings& around, const Pose2& pose, const RandomSource& random, std::uint64_t number,
                     std::span<double> ranges) const {
  assert(ranges.size() == size());
  if (settings_.firing == SonarFiring::sequential)
    std::fill(ranges.begin(), ranges.end(), std::numeric_limits<double>::quiet_NaN());
  const Round round{around, pose, std::cos(pose.yaw), std::sin(pose.yaw), random, number};
  for (std::size_t k = 0; k < firing(); ++k) {
    const std::uint16_t i = firing(k, number);
    double range = echo(round, i).distance;
    if (settings_.crosstalk > 0.0) range = disturbed(round, i, range);
    if (range < infinity) {
      // Both numbers have their places always, so that one imperfection does not change what the other does.
      auto sequence = random.at(RandomUse::sonar, i, number);
      const bool dropped = sequence.happens(settings_.drop_out);
      const double noisy = range * (1.0 + settings_.noise * sequence.gaussian());
      range = dropped || !(noisy <= ring_.max_range) ? infinity : std::max(noisy, ring_.min_range);
    }
    ranges[i] = range;
  }
}

Sonars::Echo Sonars::echo(const Round& round, std::size_t i) const {
  return settings_.rays == 1 ? echo_of<1>(round, i) : echo_of<64>(round, i);
}

template <std::size_t most>
Sonars::Echo Sonars::echo_of(const Round& round, std::size_t i) const {
  std::array<Vector2, most> turned;
  std::array<RayHit, most> hits;
  double min_cosine = min_cosine_;
  if (settings_.incidence_drop_off > 0.0) {
    auto sequence = round.random.at(RandomUse::sonar_incidence, static_cast<std::uint16_t>(i), round.number);
    min_cosine = std::cos(*settings_.incidence_limit - settings_.incidence_drop_off * sequence.uniform());
  }
  const auto rays = static_cast<std::size_t>(settings_.rays);
  const std::span<const Vector2> directions{&directions_[i * rays], rays};
  const Pose2 &body = round.pose, &mount = ring_.poses[i];
  const Vector2 origin(body.x + round.c * mount.x - round.s * mount.y, body.y + round.s * mount.x + round.c * mount.y);
  Echo nearest;
  for (std::size_t first = 0; first < rays; first += most) {
    const std::size_t count = std::min(most, rays - first);
    for (std::size_t k = 0; k < count; ++k) {
      const Vector2& d = directions[first + k];
      turned[k] = {round.c * d.x() - round.s * d.y(), round.s * d.x() + round.c * d.y()};
    }
    round.around.cast(origin, {turned.data(), count}, ring_.max_range, {hits.data(), count});
    for (std::size_t k = 0; k < count; ++k) {
      const RayHit& hit = hits[k];
      if (hit.distance >= nearest.distance) continue;
      if (-turned[k].dot(hit.normal) < min_cosine) continue;
      nearest = {hit.distance, origin + hit.distance * turned[k]};
    }
  }
  return nearest;
}

double Sonars::disturbed(const Round& round, std::size_t i, double own) const {
  const std::size_t others = firing() - 1;
  if (others == 0) return own;
  auto sequence = round.random.at(RandomUse::sonar_crosstalk, static_cast<std::uint16_t>(i), round.number);
  if (!(sequence.uniform() < settings_.crosstalk)) return own;
  // One of the first of them; the last one stands in for this one.
  const auto place = static_cast<std::size_t>(sequence.uniform() * static_cast<double>(others));
  const std::uint16_t chosen = firing(place, round.number);
  const Echo heard = echo(round, chosen == i ? firing(others, round.number) : chosen);
  const Pose2 transducer = round.pose * ring_.poses[i];
  const Vector2 way = heard.point - transducer.position();
  if (heard.distance == infinity || way.dot(geometry::heading(transducer.yaw)) <= 0.0) return own;
  return std::min(own, 0.5 * (heard.distance + way.norm()));
}

}  // namespace kervan::sim
