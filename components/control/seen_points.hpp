/// The obstacle points around a robot: those of its last scan, and those it saw before where it cannot look now.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"
#include "framework/geometry/scan.hpp"

namespace kervan::control {

struct SeenPointsParams {
  double reach = 2.5;                          ///< m; points farther from the sensor are left out
  double spacing = 0.04;                       ///< m; of points in one square of this side one is kept
  Duration memory = std::chrono::seconds(60);  ///< how long a point is kept that the sensor cannot see any more
};

/// Points stand in the frame of the odometry. A scan replaces all that it can see: what lies within its field of view
/// and no farther than its beams go. What is behind the robot, or behind something else, stays until it is seen again
/// or forgotten. Allocates nothing once it
/// has had as many points as it ever has.
class SeenPoints {
 public:
  explicit SeenPoints(const SeenPointsParams& params) : params_(params) {
    points_.reserve(usual);
    before_.reserve(usual);
  }

  /// A scan taken at `now` from `laser`, the pose of the laser in the frame of the odometry; both must be possible and
  /// finite. Ranges of -infinity (too near to be measured) and NaN tell nothing; those at or beyond range_max are free
  /// ways.
  void look(const geometry::Pose2& laser, const geometry::Scan& scan, Time now);

  /// Readings of a sensor that says where an echo came from, but not where there is none: points in the frame of the
  /// odometry. They stay for as long as those that no scan sees any more.
  void add(std::span<const geometry::Vector2> echoes, const geometry::Vector2& sensor, Time now);

  void forget() { points_.clear(); }

  struct Point {
    geometry::Vector2 at;
    Time seen;
  };
  std::span<const Point> points() const { return points_; }

 private:
  static constexpr std::size_t side = 256;    ///< squares that are told apart, both ways
  static constexpr std::size_t usual = 4096;  ///< points; more cost an allocation, once

  /// True if the square of the point has none yet in this round; then it has one.
  bool claim(const geometry::Vector2& at);
  void begin_round();

  SeenPointsParams params_;
  std::vector<Point> points_;
  std::vector<Point> before_;
  std::vector<std::uint32_t> rounds_ = std::vector<std::uint32_t>(side * side, 0u);  // in which a square got a point
  std::uint32_t round_ = 0;
};

}  // namespace kervan::control
