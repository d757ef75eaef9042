#include "sim/moving_obstacle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace kervan::sim {

bool same_place(const Pose2& a, const Pose2& b) {
  constexpr double near = 1e-9;  // m, rad
  return (a.position() - b.position()).norm() < near && std::abs(geometry::angle_between(a.yaw, b.yaw)) < near;
}

void require_valid(const MovingObstacle& obstacle) {
  if (obstacle.name.empty()) throw std::invalid_argument("a moving obstacle needs a name");
  const auto require = [&](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument("moving obstacle " + obstacle.name + ": " + what);
  };
  const std::vector<Waypoint>& path = obstacle.path;
  require(!path.empty(), "its path needs a waypoint");
  require(path.front().at >= path.front().at.zero(), "its path must not begin before 0");
  for (const Waypoint& point : path)
    require(point.pose.position().allFinite() && std::isfinite(point.pose.yaw), "its path must be finite");
  for (std::size_t i = 1; i < path.size(); ++i) require(path[i - 1].at < path[i].at, "the times of its path must grow");
  if (obstacle.repeat) {
    require(path.size() > 1, "a path that repeats needs two waypoints");
    require(same_place(path.front().pose, path.back().pose), "a path that repeats must end where it began");
  }
}

Pose2 pose_at(const MovingObstacle& obstacle, std::chrono::nanoseconds time) {
  const std::vector<Waypoint>& path = obstacle.path;
  if (time <= path.front().at) return path.front().pose;
  if (time >= path.back().at) {
    if (!obstacle.repeat) return path.back().pose;
    time = path.front().at + (time - path.front().at) % (path.back().at - path.front().at);
  }
  const auto next = std::upper_bound(path.begin(), path.end(), time,
                                     [](std::chrono::nanoseconds t, const Waypoint& point) { return t < point.at; });
  const Waypoint &from = *(next - 1), &to = *next;
  const double part = static_cast<double>((time - from.at).count()) / static_cast<double>((to.at - from.at).count());
  return {from.pose.x + part * (to.pose.x - from.pose.x), from.pose.y + part * (to.pose.y - from.pose.y),
          from.pose.yaw + part * (to.pose.yaw - from.pose.yaw)};
}

Outline rectangle_outline(const Vector2& size) {
  const double x = 0.5 * size.x(), y = 0.5 * size.y();
  return Outline({{x, -y}, {x, y}, {-x, y}, {-x, -y}});
}

Outline disc_outline(double radius) {
  constexpr int count = 32;
  std::vector<Vector2> corners;
  for (int i = 0; i < count; ++i) corners.push_back(radius * geometry::heading(2.0 * std::numbers::pi * i / count));
  return Outline(std::move(corners));
}

}  // namespace kervan::sim
