#include "sim/surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kervan::sim {

PlacedBody::PlacedBody(std::string name, Outline outline, const Pose2& pose)
    : name_(std::move(name)), outline_(std::move(outline)), corners_(outline_.corners().size()) {
  move_to(pose);
}

void PlacedBody::move_to(const Pose2& pose) {
  pose_ = pose;
  const std::span<const Vector2> corners = outline_.corners();
  for (std::size_t i = 0; i < corners.size(); ++i) corners_[i] = pose * corners[i];
}

Clearance clearance(const PlacedBody& other, const Outline& outline, const Pose2& pose) {
  const Pose2 to_body = pose.inverse();
  // One body wholly inside the other: no edges meet then.
  if (outline.contains(to_body * other.pose().position()) ||
      other.outline().contains(other.pose().inverse() * pose.position()))
    return {0.0, pose.position(), pose.position()};
  Clearance nearest;
  for (std::size_t i = 0; i < other.corners().size(); ++i) {
    const Segment edge = other.edge(i);
    const Clearance found = outline.clearance(Segment{to_body * edge.a, to_body * edge.b});
    if (found.distance < nearest.distance) nearest = found;
  }
  nearest.on_obstacle = pose * nearest.on_obstacle;
  nearest.on_outline = pose * nearest.on_outline;
  return nearest;
}

Room Surroundings::room(const Outline& outline, const Pose2& pose) const {
  Room room;
  room.all = world_.clearance(outline, pose);
  room.world = room.all.distance;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (i == self_) continue;
    const PlacedBody& other = bodies_[i];
    const double radii = outline.circumradius() + other.outline().circumradius();
    if ((other.pose().position() - pose.position()).norm() - radii >= room.all.distance) continue;
    const Clearance found = clearance(other, outline, pose);
    if (found.distance >= room.all.distance) continue;
    room.all = found;
    room.other = &other;
  }
  return room;
}

double Surroundings::room_among_robots(const Outline& outline, const Pose2& pose) const {
  double room = infinity;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (i == self_) continue;
    const double radii = outline.circumradius() + bodies_[i].outline().circumradius();
    room = std::min(room, (bodies_[i].pose().position() - pose.position()).norm() - radii);
  }
  return room;
}

std::vector<const PlacedBody*> Surroundings::robots_within(const Vector2& point, double range) const {
  std::vector<const PlacedBody*> near;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (i == self_) continue;
    if ((bodies_[i].pose().position() - point).norm() - bodies_[i].outline().circumradius() <= range)
      near.push_back(&bodies_[i]);
  }
  return near;
}

std::optional<RayHit> cast(std::span<const PlacedBody* const> bodies, const Ray& ray, double range) {
  double best = infinity;
  Segment met;
  for (const PlacedBody* body : bodies) {
    // A disc around the body is missed by most rays.
    const Vector2 to_center = body->pose().position() - ray.origin;
    const double radius = body->outline().circumradius();
    const double along = to_center.dot(ray.direction);
    if (along < -radius || along - radius > std::min(best, range)) continue;
    if (std::abs(cross(ray.direction, to_center)) > radius) continue;
    for (std::size_t i = 0; i < body->corners().size(); ++i) {
      const Segment edge = body->edge(i);
      const double distance = hit_distance(ray, edge);
      if (distance >= best) continue;
      best = distance;
      met = edge;
    }
  }
  if (!(best <= range) || best == infinity) return std::nullopt;
  return RayHit{best, hit_normal(ray, met)};
}

}  // namespace kervan::sim
