#include "sim/shapes.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::sim {

Vector2 nearest_point(const Segment& segment, const Vector2& point) {
  const Vector2 along = segment.b - segment.a;
  const double length_squared = along.squaredNorm();
  if (length_squared == 0.0) return segment.a;
  const double u = std::clamp((point - segment.a).dot(along) / length_squared, 0.0, 1.0);
  return segment.a + u * along;
}

Vector2 nearest_point(const Circle& circle, const Vector2& point) {
  const Vector2 outward = point - circle.center;
  const double distance = outward.norm();
  if (distance <= circle.radius) return point;
  return circle.center + outward * (circle.radius / distance);
}

std::array<Vector2, 4> corners(const Box& box) {
  const double x = 0.5 * box.size.x(), y = 0.5 * box.size.y();
  return {box.pose * Vector2(x, y), box.pose * Vector2(-x, y), box.pose * Vector2(-x, -y), box.pose * Vector2(x, -y)};
}

bool contains(const Box& box, const Vector2& point) {
  const Vector2 offset = point - box.pose.position();
  const Vector2 axis = geometry::heading(box.pose.yaw);
  return std::abs(offset.dot(axis)) <= 0.5 * box.size.x() && std::abs(cross(axis, offset)) <= 0.5 * box.size.y();
}

double hit_distance(const Ray& ray, const Circle& circle) {
  const Vector2 to_center = circle.center - ray.origin;
  const double gap = to_center.squaredNorm() - circle.radius * circle.radius;
  if (gap <= 0.0) return 0.0;
  const double along = to_center.dot(ray.direction);
  if (along <= 0.0) return infinity;
  const double miss = cross(ray.direction, to_center);
  const double half_chord_squared = circle.radius * circle.radius - miss * miss;
  if (half_chord_squared < 0.0) return infinity;
  // gap / (along + half chord) is along - half chord without its cancellation when the disc is far.
  return gap / (along + std::sqrt(half_chord_squared));
}

Vector2 hit_normal(const Ray& ray, const Segment& segment) {
  const Vector2 along = segment.b - segment.a;
  const Vector2 normal = Vector2(-along.y(), along.x()).normalized();
  const double facing = normal.dot(ray.direction);
  if (facing == 0.0) return -ray.direction;  // met end on
  return facing > 0.0 ? Vector2(-normal) : normal;
}

Vector2 hit_normal(const Ray& ray, const Circle& circle, double distance) {
  if (distance == 0.0) return -ray.direction;
  return (ray.origin + distance * ray.direction - circle.center) / circle.radius;
}

}  // namespace kervan::sim
