/// Keeps a robot with a laser in the map that it makes.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "components/localization/map_localizer.hpp"
#include "components/mapping/laser_mapper.hpp"

namespace kervan::localization {

struct LaserLocalizerParams {
  MapLocalizerParams localizer;
  double max_range = 30.0;  ///< m; beams that end farther away are left out
  geometry::Pose2 mount;    ///< of the laser in base_link
  Stride between_matches{0.1, 0.05};
  Stride between_insertions{0.25, 0.15};
  std::size_t most_bytes = std::size_t{128} << 20;  ///< that the map may take
};

/// The map is the localizer's own: a scan is in it at the pose that was found for it, before the next one is compared,
/// and none is that was not understood. Beams that bring nothing back are left out.
class LaserLocalizer {
 public:
  explicit LaserLocalizer(const LaserLocalizerParams& params);

  OdometryFilter& filter() { return localizer_.filter(); }
  const OdometryFilter& filter() const { return localizer_.filter(); }
  const Match& last_match() const { return localizer_.last_match(); }
  const PointMap& map() const { return map_; }

  /// A scan (laser_mapper.hpp) that was taken when base_link was at `odom`. Ranges that are none are left out and
  /// counted.
  Outcome scan(const geometry::Pose2& odom, const geometry::Scan& scan);

  std::uint64_t refused_ranges() const { return refused_ranges_; }
  /// Echoes that are not in the map because it may not grow any more.
  std::uint64_t refused_memory() const { return refused_memory_; }

 private:
  bool same_laser(const geometry::Scan& scan);
  void find_echoes(const geometry::Scan& scan);
  void insert(const geometry::Pose2& odom);

  LaserLocalizerParams params_;
  MapLocalizer localizer_;
  PointMap map_;
  struct Laser {
    std::size_t beams;
    double angle_min, angle_increment;
    bool operator==(const Laser&) const = default;
  };
  std::optional<Laser> laser_;
  std::optional<geometry::Pose2> matched_, inserted_;  // in odom
  Echoes echoes_;
  std::uint64_t refused_ranges_ = 0;
  std::uint64_t refused_memory_ = 0;
};

}  // namespace kervan::localization
