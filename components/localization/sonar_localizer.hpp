/// Keeps a robot with sonars in the map that it makes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "components/localization/map_localizer.hpp"
#include "components/localization/sonar_triangulation.hpp"

namespace kervan::localization {

/// Ways are in m, a radian of turning counting as half a metre.
struct SonarLocalizerParams {
  MapLocalizerParams localizer{.matcher = {.least_used = 20, .alike = 100.0}};
  SonarTriangulationParams triangulation;
  double between_rounds = 0.02;                     ///< rounds in between say nothing new
  double between_matches = 1.0;                     ///< the way whose rounds are compared as one
  std::size_t most_bytes = std::size_t{128} << 20;  ///< that the map may take
};

/// One round says little, so rounds are gathered over a short way, held together by the odometry, and compared as one:
/// those of their echoes of which it is known where they came from (sonar_triangulation.hpp). After that they enter the
/// map from where they turned out to have been made, so that nothing is compared with itself.
class SonarLocalizer {
 public:
  explicit SonarLocalizer(const SonarLocalizerParams& params);

  OdometryFilter& filter() { return localizer_.filter(); }
  const OdometryFilter& filter() const { return localizer_.filter(); }
  const Match& last_match() const { return localizer_.last_match(); }
  const PointMap& map() const { return map_; }

  /// A round that was made when base_link was at `odom`. All rounds must have as many sonars as the first.
  Outcome round(const geometry::Pose2& odom, std::span<const SonarEcho> echoes, const mapping::SonarLimits& limits);

  std::uint64_t refused_ranges() const { return refused_ranges_; }
  /// Echoes that are not in the map because it may not grow any more.
  std::uint64_t refused_memory() const { return refused_memory_; }

 private:
  struct Heard {
    geometry::Pose2 from;  // base_link in map, as it was believed to be
    SonarPoint point;
  };

  void find_echoes(const geometry::Pose2& from);
  void insert(const geometry::Pose2& moved);

  SonarLocalizerParams params_;
  MapLocalizer localizer_;
  SonarTriangulation triangulation_;
  PointMap map_;
  std::size_t ring_ = 0;                 // sonars of the first round
  std::optional<geometry::Pose2> last_;  // round, in odom
  double way_ = 0.0;                     // since the last match
  std::vector<Heard> heard_;             // on that
  Echoes echoes_;
  std::uint64_t refused_ranges_ = 0;
  std::uint64_t refused_memory_ = 0;
};

}  // namespace kervan::localization
