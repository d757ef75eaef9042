/// What a planar laser range finder measures in one sweep.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

namespace kervan::geometry {

/// As sensor_msgs/LaserScan has it; angles in rad from the laser's x axis, ranges in m. A range at or beyond range_max,
/// infinity included, is a beam that brought nothing back; -infinity is one that met something too near to measure
/// (REP 117); NaN and other ranges below range_min say nothing.
struct Scan {
  double angle_min = 0.0;
  double angle_increment = 0.0;
  double range_min = 0.0;
  double range_max = 0.0;
  std::span<const float> ranges;
};

/// Whether its angles and limits are those of a scan.
inline bool possible(const Scan& scan) {
  constexpr std::size_t most_beams = 1'000'000;
  constexpr double whole_turn = 2.0 * std::numbers::pi;
  return std::isfinite(scan.angle_min) && std::isfinite(scan.angle_increment) && scan.angle_increment != 0.0 &&
         std::isfinite(scan.range_min) && scan.range_min >= 0.0 && !std::isnan(scan.range_max) &&
         scan.range_max > scan.range_min && scan.ranges.size() <= most_beams &&
         std::abs(scan.angle_increment) * static_cast<double>(scan.ranges.size()) < 2.0 * whole_turn;
}

}  // namespace kervan::geometry
