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
  echoes_.resize(ring.poses.size());
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
                     std::span<double> ranges) {
  SonarVolley alone;
  alone.add(*this, around, pose, random, number, ranges);
  alone.fire();
}

void Sonars::read(const Round& round) const {
  if (settings_.firing == SonarFiring::sequential)
    std::fill(round.ranges.begin(), round.ranges.end(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < firing(); ++k) {
    const std::uint16_t i = firing(k, round.number);
    double range = echoes_[i].distance;
    if (settings_.crosstalk > 0.0) range = disturbed(round, i, range);
    if (range < infinity) {
      // Both numbers have their places always, so that one imperfection does not change what the other does.
      auto sequence = round.random->at(RandomUse::sonar, i, round.number);
      const bool dropped = sequence.happens(settings_.drop_out);
      const double noisy = range * (1.0 + settings_.noise * sequence.gaussian());
      range = dropped || !(noisy <= ring_.max_range) ? infinity : std::max(noisy, ring_.min_range);
    }
    round.ranges[i] = range;
  }
}

/// The rays of a volley that wait until they are cast.
struct SonarVolley::Rays {
  struct Owner {
    std::size_t ring;
    std::uint16_t sonar;
  };
  std::array<Vector2, most_rays> turned;
  std::array<RayHit, most_rays> hits;
  std::array<RayFan, most_rays> fans;
  std::array<Owner, most_rays> owners;  // of the fans
  std::size_t count = 0, fan_count = 0;
  double range = 0.0;  // m; of all of them
};

void SonarVolley::add(Sonars& sonars, const Surroundings& around, const Pose2& pose, const RandomSource& random,
                      std::uint64_t round, std::span<double> ranges) {
  assert(ranges.size() == sonars.size() && count_ < most);
  if (sonars.size() > 0) rings_[count_++].emplace(Ring{&sonars, {around, pose, &random, round, ranges}});
}

void SonarVolley::fire() {
  // Of each thread one, because clearing them would take longer than a ring of a few rays.
  static thread_local Rays rays;
  for (std::size_t r = 0; r < count_; ++r) aim(r, rays);
  cast(rays);
  for (std::size_t r = 0; r < count_; ++r) rings_[r]->sonars->read(rings_[r]->round);
  count_ = 0;
}

void SonarVolley::aim(std::size_t ring, Rays& rays) {
  auto& [sonars, round] = *rings_[ring];
  if (rays.range != sonars->ring_.max_range) cast(rays);
  rays.range = sonars->ring_.max_range;
  const Pose2& body = round.pose;
  const double c = std::cos(body.yaw), s = std::sin(body.yaw);
  const auto all = static_cast<std::size_t>(sonars->settings_.rays);
  for (std::size_t k = 0; k < sonars->firing(); ++k) {
    const std::uint16_t i = sonars->firing(k, round.number);
    const Pose2& mount = sonars->ring_.poses[i];
    const Vector2 origin(body.x + c * mount.x - s * mount.y, body.y + s * mount.x + c * mount.y);
    sonars->echoes_[i] = {};
    for (std::size_t first = 0; first < all;) {
      if (rays.count == most_rays) cast(rays);
      const std::size_t now = std::min(most_rays - rays.count, all - first);
      Vector2* const turned = &rays.turned[rays.count];
      for (std::size_t ray = 0; ray < now; ++ray) {
        const Vector2& d = sonars->directions_[i * all + first + ray];
        turned[ray] = {c * d.x() - s * d.y(), s * d.x() + c * d.y()};
      }
      rays.fans[rays.fan_count] = {origin, {turned, now}};
      rays.owners[rays.fan_count++] = {ring, i};
      rays.count += now;
      first += now;
    }
  }
}

void SonarVolley::cast(Rays& rays) {
  if (rays.count == 0) return;
  // Only an incidence limit asks how a surface is met.
  const auto normals = [this](std::size_t ring) {
    return rings_[ring]->sonars->settings_.incidence_limit ? Normals::wanted : Normals::unwanted;
  };
  Normals any = Normals::unwanted;
  for (std::size_t r = rays.owners[0].ring; r <= rays.owners[rays.fan_count - 1].ring; ++r)
    if (normals(r) == Normals::wanted) any = Normals::wanted;
  const std::span<const RayFan> fans{rays.fans.data(), rays.fan_count};
  rings_[0]->round.around.world().cast(fans, rays.range, {rays.hits.data(), rays.count}, any);
  RayHit* hits = rays.hits.data();
  for (std::size_t first = 0; first < rays.fan_count;) {
    const std::size_t r = rays.owners[first].ring;
    std::size_t last = first, count = 0;
    for (; last < rays.fan_count && rays.owners[last].ring == r; ++last) count += fans[last].directions.size();
    const auto& [sonars, round] = *rings_[r];
    round.around.cast_among_bodies(fans.subspan(first, last - first), rays.range, {hits, count}, normals(r));
    for (; first < last; hits += fans[first++].directions.size())
      sonars->take_echo(round, rays.owners[first].sonar, fans[first], hits, sonars->echoes_[rays.owners[first].sonar]);
  }
  rays.count = rays.fan_count = 0;
}

void Sonars::take_echo(const Round& round, std::uint16_t i, const RayFan& rays, const RayHit* hits,
                       Echo& nearest) const {
  double min_cosine = min_cosine_;
  if (settings_.incidence_drop_off > 0.0) {
    auto sequence = round.random->at(RandomUse::sonar_incidence, i, round.number);
    min_cosine = std::cos(*settings_.incidence_limit - settings_.incidence_drop_off * sequence.uniform());
  }
  for (const Vector2& direction : rays.directions) {
    const RayHit& hit = *hits++;
    if (hit.distance >= nearest.distance) continue;
    if (-direction.dot(hit.normal) < min_cosine) continue;
    nearest = {hit.distance, rays.origin + hit.distance * direction};
  }
}

double Sonars::disturbed(const Round& round, std::size_t i, double own) const {
  const std::size_t others = firing() - 1;
  if (others == 0) return own;
  auto sequence = round.random->at(RandomUse::sonar_crosstalk, static_cast<std::uint16_t>(i), round.number);
  if (!(sequence.uniform() < settings_.crosstalk)) return own;
  // One of the first of them; the last one stands in for this one.
  const auto place = static_cast<std::size_t>(sequence.uniform() * static_cast<double>(others));
  const std::uint16_t chosen = firing(place, round.number);
  const Echo& heard = echoes_[chosen == i ? firing(others, round.number) : chosen];
  const Pose2 transducer = round.pose * ring_.poses[i];
  const Vector2 way = heard.point - transducer.position();
  if (heard.distance == infinity || way.dot(geometry::heading(transducer.yaw)) <= 0.0) return own;
  return std::min(own, 0.5 * (heard.distance + way.norm()));
}

}  // namespace kervan::sim
