#include "sim/robot_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <utility>

namespace kervan::sim {

namespace {

/// Both ends of a segment, the right one first as seen from the body.
std::array<Vector2, 2> ends(const Pose2& segment, double length) {
  return {segment * Vector2(0.0, -0.5 * length), segment * Vector2(0.0, 0.5 * length)};
}

/// Counter-clockwise and strictly convex (Andrew 1979).
std::vector<Vector2> convex_hull(std::vector<Vector2> points) {
  double extent = 0.0;  // m2
  for (const Vector2& point : points) extent = std::max(extent, point.squaredNorm());
  const double straight = 1e-9 * extent;  // corners that bend less are left out
  std::sort(points.begin(), points.end(),
            [](const Vector2& a, const Vector2& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  std::vector<Vector2> hull;
  const auto add = [&hull, straight](const Vector2& point, std::size_t first) {
    while (hull.size() >= first + 2 && cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= straight)
      hull.pop_back();
    hull.push_back(point);
  };
  for (const Vector2& point : points) add(point, 0);
  const std::size_t lower = hull.size() - 1;
  for (auto point = points.rbegin() + 1; point != points.rend(); ++point) add(*point, lower);
  hull.pop_back();  // the first point again
  return hull;
}

Outline hull(const Outline& body, std::span<const Pose2> segments, double length) {
  std::vector<Vector2> points(body.corners().begin(), body.corners().end());
  for (const Pose2& segment : segments)
    for (const Vector2& end : ends(segment, length)) points.push_back(end);
  return Outline(convex_hull(std::move(points)));
}

std::vector<Pose2> segments_of(const BumperMount& bumpers, BumperSet set) {
  std::vector<Pose2> segments;
  if (set == BumperSet::front || set == BumperSet::both) segments = bumpers.front;
  if (set == BumperSet::rear || set == BumperSet::both)
    segments.insert(segments.end(), bumpers.rear.begin(), bumpers.rear.end());
  return segments;
}

}  // namespace

std::vector<Pose2> fitted_bumpers(const RobotModel& model) { return segments_of(model.bumpers, model.fitted); }

RobotModel with_bumpers(RobotModel model, BumperSet fitted) {
  if (fitted == BumperSet::none) return model;
  if (fitted != BumperSet::rear && model.bumpers.front.empty())
    throw std::invalid_argument("the model " + model.name + " has no front bumpers");
  if (fitted != BumperSet::front && model.bumpers.rear.empty())
    throw std::invalid_argument("the model " + model.name + " has no rear bumpers");
  model.fitted = fitted;
  model.outline = hull(model.outline, fitted_bumpers(model), model.bumpers.length);
  return model;
}

double depth_of_bumper(const RobotModel& model, const Pose2& segment) {
  const Outline all = hull(model.outline, segments_of(model.bumpers, BumperSet::both), model.bumpers.length);
  const auto depth = [&all](const Vector2& point) {
    double least = infinity;
    for (std::size_t i = 0; i < all.corners().size(); ++i) {
      const Vector2& a = all.corners()[i];
      const Vector2& b = all.corners()[(i + 1) % all.corners().size()];
      least = std::min(least, cross((b - a).normalized(), point - a));
    }
    return std::max(0.0, least);
  };
  const auto [right, left] = ends(segment, model.bumpers.length);
  return std::max({depth(right), depth(segment.position()), depth(left)});
}

void require_valid(const RobotModel& model) {
  const auto require = [&](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument("robot model " + model.name + ": " + what);
  };
  const DriveLimits& drive = model.drive;
  for (const double limit :
       {drive.speed, drive.turn_rate, drive.acceleration, drive.deceleration, drive.angular_acceleration})
    require(limit > 0.0 && std::isfinite(limit), "every limit of the drive must be a positive number");
  if (model.drive_type == DriveType::differential)
    require(model.track > 0.0 && std::isfinite(model.track), "the track of a differential drive must be positive");
  else
    require(model.track == 0.0, "a synchro drive has no track");
  if (const auto& laser = model.laser) {
    require(laser->beams >= 2, "the laser needs at least 2 beams");
    require(laser->field_of_view > 0.0 && laser->field_of_view < 2.0 * std::numbers::pi,
            "the laser's field of view must be in (0, 2 pi)");
    require(laser->min_range >= 0.0 && laser->min_range < laser->max_range && std::isfinite(laser->max_range),
            "the laser needs 0 <= min_range < max_range");
  }
  const BumperMount& bumpers = model.bumpers;
  require((bumpers.front.empty() && bumpers.rear.empty()) || (bumpers.length > 0.0 && std::isfinite(bumpers.length)),
          "the segments of the bumpers must have a length");
  const SonarRing& sonars = model.sonars;
  std::vector<int> uses(sonars.poses.size(), sonars.arrays.empty() ? 1 : 0);
  for (const auto& array : sonars.arrays) {
    require(!array.empty(), "an array of sonars must not be empty");
    for (const std::uint16_t i : array) {
      require(i < uses.size(), "the arrays of the sonars name one that there is not");
      ++uses[i];
    }
  }
  require(std::all_of(uses.begin(), uses.end(), [](int n) { return n == 1; }),
          "each sonar must be in one array, and in one only");
  if (sonars.poses.empty()) return;
  require(sonars.min_range >= 0.0 && sonars.min_range < sonars.max_range && std::isfinite(sonars.max_range),
          "the sonars need 0 <= min_range < max_range");
  require(sonars.field_of_view > 0.0 && sonars.field_of_view <= std::numbers::pi,
          "the sonars' field of view must be in (0, pi]");
}

}  // namespace kervan::sim
