/// The shapes that obstacles are made of, and exact questions about one of them. Metres, in the frame the shape is in.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "framework/geometry/pose2.hpp"

namespace kervan::sim {

using geometry::Pose2;
using geometry::Vector2;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// A wall without thickness, seen from both sides.
struct Segment {
  Vector2 a;
  Vector2 b;
};

/// A solid disc.
struct Circle {
  Vector2 center;
  double radius;
};

/// A solid rectangle: `pose` is its centre, size.x() its extent along the pose's x axis.
struct Box {
  Pose2 pose;
  Vector2 size;
};

/// A half line; `direction` has length 1.
struct Ray {
  Vector2 origin;
  Vector2 direction;
};

/// Rays from one point, whose directions have length 1.
struct RayFan {
  Vector2 origin;
  std::span<const Vector2> directions;
};

/// The z component of a x b: positive if b points to the left of a.
inline double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The point of the segment nearest to `point`. A segment of length 0 is its end point.
Vector2 nearest_point(const Segment& segment, const Vector2& point);

/// The point of the solid disc nearest to `point`: the point itself if it lies inside.
Vector2 nearest_point(const Circle& circle, const Vector2& point);

/// The corners of the rectangle, counter-clockwise, in the frame its pose is in.
std::array<Vector2, 4> corners(const Box& box);

/// True if the point lies in the solid rectangle or on its edge.
bool contains(const Box& box, const Vector2& point);

/// Metres along the ray to the shape, 0 if the origin lies on it (or inside a disc), infinity if the ray misses it.
/// Segments are lengthened by a nanometre at both ends, so that no ray slips through where two of them meet.
inline double hit_distance(const Ray& ray, const Segment& segment) {
  constexpr double seam = 1e-9;  // m
  const Vector2 along = segment.b - segment.a;
  const Vector2 to_a = segment.a - ray.origin;
  const double across = cross(ray.direction, along);
  const double offset = cross(to_a, ray.direction);
  if (across == 0.0) {  // parallel: the ray meets at most an end of the segment, or starts on it
    if (std::abs(offset) > seam) return infinity;
    const double t_a = to_a.dot(ray.direction);
    const double t_b = (segment.b - ray.origin).dot(ray.direction);
    const double farther = std::max(t_a, t_b);
    return farther < 0.0 ? infinity : std::max(0.0, std::min(t_a, t_b));
  }
  // |across| is the segment's length seen across the ray, so the seam is compared in the same measure.
  const double u = across > 0.0 ? offset : -offset;
  const double width = std::abs(across);
  if (u < -seam || u > width + seam) return infinity;
  const double distance = cross(to_a, along) / across;
  return distance >= 0.0 ? distance : infinity;
}
double hit_distance(const Ray& ray, const Circle& circle);

/// The unit normal of the surface where the ray meets the shape, on the ray's side: normal · direction <= 0.
/// `distance` is what hit_distance gave.
Vector2 hit_normal(const Ray& ray, const Segment& segment);
Vector2 hit_normal(const Ray& ray, const Circle& circle, double distance);

}  // namespace kervan::sim
