#include "sim/outline.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace kervan::sim {

Outline::Outline(std::vector<Vector2> corners) : corners_(std::move(corners)) {
  const std::size_t count = corners_.size();
  if (count < 3) throw std::invalid_argument("an outline needs at least 3 corners");
  double turned = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!corners_[i].allFinite()) throw std::invalid_argument("the corners of an outline must be finite");
    const Vector2 along = edge(i).b - edge(i).a;
    const Vector2 next = edge((i + 1) % count).b - edge((i + 1) % count).a;
    if (!(cross(along, next) > 0.0))
      throw std::invalid_argument("the corners of an outline must be convex and counter-clockwise");
    turned += std::atan2(cross(along, next), along.dot(next));
    outward_.push_back(Vector2(along.y(), -along.x()).normalized());
    circumradius_ = std::max(circumradius_, corners_[i].norm());
    inradius_ = std::min(inradius_, outward_[i].dot(corners_[i]));
  }
  // A star turns left at every corner as well, but more than once around.
  if (turned > 3.0 * std::numbers::pi) throw std::invalid_argument("the edges of an outline must not cross");
  if (!contains(Vector2::Zero())) throw std::invalid_argument("an outline must hold the origin of its frame");
}

bool Outline::contains(const Vector2& point) const {
  for (std::size_t i = 0; i < corners_.size(); ++i)
    if (height(i, point) > 0.0) return false;
  return true;
}

Clearance Outline::clearance(const Segment& segment) const {
  // Clip the segment by the half plane of each edge (Cyrus and Beck 1978): what is left overlaps the body.
  const Vector2 along = segment.b - segment.a;
  double from = 0.0, to = 1.0;
  for (std::size_t i = 0; i < corners_.size() && from <= to; ++i) {
    const double start = height(i, segment.a);
    const double slope = outward_[i].dot(along);
    if (slope == 0.0) {
      if (start > 0.0) to = -1.0;
    } else if (slope < 0.0) {
      from = std::max(from, -start / slope);
    } else {
      to = std::min(to, -start / slope);
    }
  }
  if (from <= to) {
    const Vector2 inside = segment.a + 0.5 * (from + to) * along;
    return {0.0, inside, inside};
  }

  // Apart from each other, a corner of one of the two is always among the nearest pair; and what lies behind an edge is
  // not nearest to it.
  double nearest_squared = infinity;
  Clearance nearest;
  const auto consider = [&](const Vector2& on_obstacle, const Vector2& on_outline) {
    const double squared = (on_obstacle - on_outline).squaredNorm();
    if (squared < nearest_squared) {
      nearest_squared = squared;
      nearest.on_obstacle = on_obstacle;
      nearest.on_outline = on_outline;
    }
  };
  constexpr double behind = -1e-9;  // m; more than rounding
  const std::size_t last = corners_.size() - 1;
  bool after = std::max(height(last, segment.a), height(last, segment.b)) > behind;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const double a = height(i, segment.a), b = height(i, segment.b);
    const bool before = std::exchange(after, std::max(a, b) > behind);
    if (before || after) consider(nearest_point(segment, corners_[i]), corners_[i]);
    if (a > behind) consider(segment.a, nearest_point(edge(i), segment.a));
    if (b > behind) consider(segment.b, nearest_point(edge(i), segment.b));
  }
  nearest.distance = std::sqrt(nearest_squared);
  return nearest;
}

Clearance Outline::clearance(const Circle& circle) const {
  if (contains(circle.center)) return {0.0, circle.center, circle.center};
  double nearest_squared = infinity;
  Vector2 on_outline = Vector2::Zero();
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Vector2 point = nearest_point(edge(i), circle.center);
    const double squared = (point - circle.center).squaredNorm();
    if (squared < nearest_squared) {
      nearest_squared = squared;
      on_outline = point;
    }
  }
  const double distance = std::max(0.0, std::sqrt(nearest_squared) - circle.radius);
  return {distance, nearest_point(circle, on_outline), on_outline};
}

}  // namespace kervan::sim
