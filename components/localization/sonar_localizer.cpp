#include "components/localization/sonar_localizer.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::localization {
namespace {

using geometry::Pose2;

constexpr double metres_per_radian = 0.5;

constexpr double farthest_transducer = 10.0;  // m from base_link

bool possible(std::span<const SonarEcho> echoes, const mapping::SonarLimits& limits) {
  return limits.min_range >= 0.0 && limits.max_range > limits.min_range &&
         std::all_of(echoes.begin(), echoes.end(), [](const SonarEcho& echo) {
           return std::abs(echo.transducer.x) <= farthest_transducer &&
                  std::abs(echo.transducer.y) <= farthest_transducer && std::isfinite(echo.transducer.yaw);
         });
}

}  // namespace

SonarLocalizer::SonarLocalizer(const SonarLocalizerParams& params)
    : params_(params),
      localizer_(params.localizer),
      triangulation_(params.triangulation),
      map_(params.localizer.matcher.resolution, params.most_bytes) {}

Outcome SonarLocalizer::round(const Pose2& odom, std::span<const SonarEcho> echoes,
                              const mapping::SonarLimits& limits) {
  if (echoes.empty() || !possible(echoes, limits)) return Outcome::refused_scan;
  if (ring_ == 0) ring_ = echoes.size();
  if (echoes.size() != ring_) return Outcome::refused_scan;
  const Pose2 before = localizer_.expected(odom);
  if (!grid::has_cell(before.position())) return Outcome::refused_place;
  if (last_) {
    const double way = (odom.position() - last_->position()).norm() +
                       metres_per_radian * std::abs(geometry::angle_between(last_->yaw, odom.yaw));
    if (way < params_.between_rounds) return Outcome::waiting;
    way_ += way;
  }
  last_ = odom;
  for (const SonarEcho& echo : echoes)
    if (echo.range < 0.0) ++refused_ranges_;
  for (const SonarPoint& point : triangulation_.round(odom, echoes, limits)) heard_.push_back({before, point});
  if (way_ < params_.between_matches) return Outcome::waiting;

  way_ = 0.0;
  Outcome outcome = Outcome::began;
  if (!map_.box().empty()) {
    find_echoes(before);
    outcome = localizer_.align(map_, echoes_, odom);
  }
  // What does not fit would be drawn over what others are to be compared with.
  if (outcome != Outcome::poor && outcome != Outcome::ambiguous) insert(localizer_.expected(odom) * before.inverse());
  heard_.clear();
  return outcome;
}

/// All that was heard, as seen from `from`.
void SonarLocalizer::find_echoes(const Pose2& from) {
  echoes_.clear();
  const Pose2 to_robot = from.inverse();
  for (const Heard& heard : heard_) echoes_.push_back(to_robot * (heard.from * heard.point.point));
}

/// Puts what was heard into the map, `moved` (in map) from where it was believed to be.
void SonarLocalizer::insert(const Pose2& moved) {
  for (const Heard& heard : heard_) {
    const Pose2 from = moved * heard.from;
    refused_memory_ += !map_.add(from * heard.point.transducer, from * heard.point.point);
  }
}

}  // namespace kervan::localization
