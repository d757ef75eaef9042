#include "components/exploration/visit_counter.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::exploration {
namespace {

using geometry::Vector2;

/// Where the line from `a`, within the circle around `center`, to `b`, not within it, leaves it: 0 .. 1.
double leaves(const Vector2& a, const Vector2& b, const Vector2& center, double radius) {
  const Vector2 along = b - a, from = a - center;
  const double p = along.dot(from), q = from.squaredNorm() - radius * radius, r = along.squaredNorm();
  return std::clamp((std::sqrt(std::max(0.0, p * p - r * q)) - p) / r, 0.0, 1.0);
}

}  // namespace

void VisitCounter::begin(const Vector2& position) {
  last_ = position;
  points_.clear();
}

void VisitCounter::route(std::span<const Vector2> points) {
  points_.clear();
  if (points.empty()) return;
  // A robot that has been driven off its route without coming to a point begins anew where it is.
  const Vector2 from = (points.front() - last_).norm() < params_.spacing ? last_ : points.front();
  bool left = false;
  double due = params_.spacing;  // m along the route to the next point, once the circle is left
  for (std::size_t i = 1; i < points.size(); ++i) {
    Vector2 a = points[i - 1];
    const Vector2 b = points[i];
    if (!left) {
      if ((b - from).norm() < params_.spacing) continue;
      left = true;
      a += leaves(a, b, from, params_.spacing) * (b - a);
      points_.push_back(a);
    }
    const double length = (b - a).norm();
    for (; due <= length; due += params_.spacing) points_.push_back(a + due / length * (b - a));
    due -= length;
  }
}

bool VisitCounter::look(const Vector2& position) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!((points_[i] - position).norm() <= params_.within)) continue;
    last_ = points_[i];
    points_.erase(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    ++visited_;
    return true;
  }
  return false;
}

}  // namespace kervan::exploration
