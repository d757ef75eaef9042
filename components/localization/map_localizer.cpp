#include "components/localization/map_localizer.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::localization {

const char* reason(Outcome outcome) {
  switch (outcome) {
    case Outcome::line: return "what is seen fits anywhere along a line: dead reckoning along it";
    case Outcome::unknown: return "the map says too little about what is seen: dead reckoning";
    case Outcome::poor: return "what is seen does not fit the map: dead reckoning";
    case Outcome::ambiguous: return "what is seen fits the map in two places: dead reckoning";
    case Outcome::refused_scan: return "it cannot be, or is not what came before";
    case Outcome::refused_place: return "the robot is too far away from the map's origin";
    case Outcome::waiting:
    case Outcome::began:
    case Outcome::matched: break;
  }
  return "";
}

SearchWindow MapLocalizer::window() const {
  const Covariance covariance = filter_.covariance();
  const double distance = 3.0 * std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
  const double turn = 3.0 * std::sqrt(covariance(2, 2));
  return {std::clamp(distance, params_.narrowest.distance, params_.widest.distance),
          std::clamp(turn, params_.narrowest.turn, params_.widest.turn)};
}

Outcome MapLocalizer::take(const geometry::Pose2& odom) {
  switch (match_.kind) {
    case MatchKind::too_few: return Outcome::unknown;
    case MatchKind::poor: return Outcome::poor;
    case MatchKind::ambiguous: return Outcome::ambiguous;
    case MatchKind::matched: break;
  }
  const geometry::Pose2 before = expected(odom);
  filter_.correct(
      {match_.pose.x - before.x, match_.pose.y - before.y, geometry::angle_between(before.yaw, match_.pose.yaw)},
      match_.covariance);
  return match_.line ? Outcome::line : Outcome::matched;
}

}  // namespace kervan::localization
