#include "components/localization/laser_localizer.hpp"

#include <cmath>

namespace kervan::localization {

using geometry::Pose2;

LaserLocalizer::LaserLocalizer(const LaserLocalizerParams& params)
    : params_(params), localizer_(params.localizer), map_(params.localizer.matcher.resolution, params.most_bytes) {}

Outcome LaserLocalizer::scan(const Pose2& odom, const geometry::Scan& scan) {
  if (!geometry::possible(scan) || !same_laser(scan)) return Outcome::refused_scan;
  if (!grid::has_cell(localizer_.expected(odom).position())) return Outcome::refused_place;
  if (matched_ && !params_.between_matches.exceeded(*matched_, odom)) return Outcome::waiting;
  matched_ = odom;
  find_echoes(scan);
  const Outcome outcome = map_.box().empty() ? Outcome::began : localizer_.align(map_, echoes_, odom);
  // What does not fit would be drawn over what others are to be compared with.
  if (outcome == Outcome::poor || outcome == Outcome::ambiguous) return outcome;
  if (inserted_ && !params_.between_insertions.exceeded(*inserted_, odom)) return outcome;
  insert(odom);
  return outcome;
}

bool LaserLocalizer::same_laser(const geometry::Scan& scan) {
  const Laser laser{scan.ranges.size(), scan.angle_min, scan.angle_increment};
  if (!laser_) laser_ = laser;
  return *laser_ == laser;
}

void LaserLocalizer::find_echoes(const geometry::Scan& scan) {
  echoes_.clear();
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = static_cast<double>(scan.ranges[i]);
    if (std::isnan(range) || (range < 0.0 && std::isfinite(range))) ++refused_ranges_;
    if (!(range >= scan.range_min && range < scan.range_max && range <= params_.max_range)) continue;
    const double angle = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    echoes_.push_back(params_.mount * geometry::Vector2(range * geometry::heading(angle)));
  }
}

void LaserLocalizer::insert(const Pose2& odom) {
  const Pose2 robot = localizer_.expected(odom), laser = robot * params_.mount;
  for (const geometry::Vector2& place : echoes_) refused_memory_ += !map_.add(laser.position(), robot * place);
  inserted_ = odom;
}

}  // namespace kervan::localization
