/// Keeps a robot in the map that it makes: dead reckoning, corrected by what its sensors see again.
#pragma once

#include <cstdint>
#include <optional>

#include "components/localization/correlative_matcher.hpp"
#include "components/localization/odometry_filter.hpp"

namespace kervan::localization {

struct MapLocalizerParams {
  geometry::Pose2 start = {};  ///< in map, of the frame that odometry is told in
  OdometryFilterParams odometry = {};
  CorrelativeMatcherParams matcher = {};
  /// Three standard deviations of the pose are searched, but neither less nor more than these.
  SearchWindow narrowest{0.15, 0.05};
  SearchWindow widest{1.0, 0.5};
};

/// How far the robot goes, or turns, between two times that something is done.
struct Stride {
  double distance = 0.0;  ///< m
  double turn = 0.0;      ///< rad

  bool exceeded(const geometry::Pose2& from, const geometry::Pose2& to) const {
    return (to.position() - from.position()).norm() >= distance ||
           std::abs(geometry::angle_between(from.yaw, to.yaw)) >= turn;
  }
};

/// What became of a sensor's reading.
enum class Outcome {
  waiting,       ///< the robot has hardly moved since the last one that was compared, or more have to come first
  began,         ///< nothing was in the map before it
  matched,       ///< the pose was corrected
  line,          ///< it was, but not along a line that the echoes say nothing about
  unknown,       ///< the map says nothing about most of it: dead reckoning
  poor,          ///< it fits the map nowhere near: dead reckoning
  ambiguous,     ///< it fits in two places: dead reckoning
  refused_scan,  ///< it cannot be, or is not of the sensor that the first one came from
  refused_place  ///< the robot is nowhere that has a cell
};

inline constexpr std::size_t outcomes = 9;

/// Whether the pose is better than dead reckoning for it.
constexpr bool corrected(Outcome outcome) { return outcome == Outcome::matched || outcome == Outcome::line; }

/// One sentence why the pose is, or may be, dead reckoning; empty if it is not, or nothing is known yet.
const char* reason(Outcome outcome);

/// The part that does not depend on the sensor.
class MapLocalizer {
 public:
  explicit MapLocalizer(const MapLocalizerParams& params)
      : params_(params), filter_(params.odometry, params.start), matcher_(params.matcher) {}

  OdometryFilter& filter() { return filter_; }
  const OdometryFilter& filter() const { return filter_; }
  const Match& last_match() const { return match_; }

  /// Where base_link is in map when it is at `odom`, a pose of now or a moment ago.
  geometry::Pose2 expected(const geometry::Pose2& odom) const { return filter_.map_to_odom() * odom; }

  /// Compares echoes, seen from `odom`, with the map, and corrects the pose if they fit.
  Outcome align(const PointMap& map, const Echoes& echoes, const geometry::Pose2& odom) {
    match_ = matcher_.match(map, echoes, expected(odom), window());
    return take(odom);
  }

 private:
  SearchWindow window() const;
  Outcome take(const geometry::Pose2& odom);

  MapLocalizerParams params_;
  OdometryFilter filter_;
  CorrelativeMatcher matcher_;
  Match match_;
};

}  // namespace kervan::localization
