#include "sim/laser.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <stdexcept>

namespace kervan::sim {

Laser::Laser(const LaserMount& mount, const LaserSettings& settings) : mount_(mount), settings_(settings) {
  if (!(settings.noise >= 0.0)) throw std::invalid_argument("the noise of the laser must not be negative");
  if (!(settings.noise_share >= 0.0))
    throw std::invalid_argument("the noise of the laser must not be a negative share of the range");
  if (!(settings.drop_out >= 0.0 && settings.drop_out <= 1.0))
    throw std::invalid_argument("the drop-out probability of the laser must be in [0, 1]");
  for (int i = 0; i < mount.beams; ++i)
    directions_.push_back(geometry::heading(mount.pose.yaw - 0.5 * mount.field_of_view + i * beam_spacing(mount)));
}

void Laser::measure(const Surroundings& around, const Pose2& pose, const RandomSource& random, std::uint64_t scan,
                    std::span<double> ranges) const {
  assert(ranges.size() == size());
  std::array<Vector2, most_rays> turned;
  static thread_local std::array<RayHit, most_rays> hits;  // clearing them each time would cost
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  const Vector2 origin = pose * mount_.pose.position();
  for (std::size_t first = 0; first < size(); first += most_rays) {
    const std::size_t count = std::min(most_rays, size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Vector2& d = directions_[first + i];
      turned[i] = {c * d.x() - s * d.y(), s * d.x() + c * d.y()};
    }
    const RayFan fan{origin, {turned.data(), count}};
    around.cast({&fan, 1}, mount_.max_range, {hits.data(), count}, Normals::unwanted);
    for (std::size_t i = 0; i < count; ++i) {
      double range = hits[i].distance;
      if (range < infinity) {
        // All numbers have their places always, so that one imperfection does not change what the other does.
        auto sequence = random.at(RandomUse::laser, static_cast<std::uint16_t>(first + i), scan);
        const bool dropped = sequence.happens(settings_.drop_out);
        const double exact = range;
        range += sequence.uniform(-settings_.noise, settings_.noise);
        if (settings_.noise_share > 0.0) range += settings_.noise_share * exact * sequence.gaussian();
        if (dropped || !(range <= mount_.max_range))
          range = infinity;
        else if (range < mount_.min_range)
          range = -infinity;
      }
      ranges[first + i] = range;
    }
  }
}

}  // namespace kervan::sim
