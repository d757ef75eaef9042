#include "sim/surroundings.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace kervan::sim {

namespace {

/// More than the rounding of the distances that are compared with it, so that what is left out never depends on the
/// order in which bodies are visited.
constexpr double doubt = 1e-9;

/// From corner `i` to the next.
Segment edge(std::span<const Vector2> corners, std::size_t i) {
  return {corners[i], corners[i + 1 == corners.size() ? 0 : i + 1]};
}

/// Rays from one point that turn counter-clockwise; finds those that point at a disc without asking each.
class Bundle {
 public:
  explicit Bundle(std::span<const Vector2> directions) : directions_(directions) {}

  /// Calls visit(ray) for all rays that pass within `radius` of the point `to_center` from their origin, and some more.
  template <class Visit>
  void visit_towards(const Vector2& to_center, double radius, Visit&& visit) const {
    constexpr std::size_t few = 4;
    constexpr double blur = 1e-6;  // rad; more than the rounding of what turned() compares
    const std::size_t count = directions_.size();
    const double distance = to_center.norm();
    const double wide = radius + blur * distance;
    if (count <= few || distance <= wide) return visit_all(0, count, visit);
    const double sine = wide / distance, cosine = std::sqrt(1.0 - sine * sine);
    const Vector2 u = to_center / distance;
    const double right = turned({cosine * u.x() + sine * u.y(), cosine * u.y() - sine * u.x()});
    const double left = turned({cosine * u.x() - sine * u.y(), cosine * u.y() + sine * u.x()});
    if (right <= left) return visit_all(first_from(right), first_from(left), visit);
    visit_all(0, first_from(left), visit);  // the first ray points at it
    visit_all(first_from(right), count, visit);
  }

 private:
  /// Grows with the angle from the first ray to `direction`, from 0 to 4 for a full turn.
  double turned(const Vector2& direction) const {
    const double along = directions_[0].dot(direction);
    return cross(directions_[0], direction) >= 0.0 ? 1.0 - along : 3.0 + along;
  }
  std::size_t first_from(double turn) const {
    std::size_t from = 0, to = directions_.size();
    while (from < to) {
      const std::size_t middle = (from + to) / 2;
      if (turned(directions_[middle]) < turn)
        from = middle + 1;
      else
        to = middle;
    }
    return from;
  }
  template <class Visit>
  static void visit_all(std::size_t from, std::size_t to, Visit& visit) {
    for (std::size_t i = from; i < to; ++i) visit(i);
  }

  std::span<const Vector2> directions_;
};

}  // namespace

Clearance clearance(const Bodies& bodies, std::size_t other, const Outline& outline, const Pose2& pose) {
  const Pose2 to_body = pose.inverse();
  const double c = std::cos(to_body.yaw), s = std::sin(to_body.yaw);
  const auto in_body = [&](const Vector2& p) {
    return Vector2(to_body.x + c * p.x() - s * p.y(), to_body.y + s * p.x() + c * p.y());
  };
  // One body wholly inside the other: no edges meet then.
  const double apart = (bodies.center(other) - pose.position()).norm();
  if (apart <= std::max(outline.circumradius(), bodies.radius(other)) + doubt &&
      (outline.contains(in_body(bodies.center(other))) ||
       bodies.outline(other).contains(bodies.pose(other).inverse() * pose.position())))
    return {0.0, pose.position(), pose.position()};
  Clearance nearest;
  const std::span<const Vector2> corners = bodies.corners(other);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Segment side{in_body(edge(corners, i).a), in_body(edge(corners, i).b)};
    if (outline.separation(side) > nearest.distance + doubt) continue;
    const Clearance found = outline.clearance(side);
    if (found.distance < nearest.distance) nearest = found;
  }
  nearest.on_obstacle = pose * nearest.on_obstacle;
  nearest.on_outline = pose * nearest.on_outline;
  return nearest;
}

Room Surroundings::room(const Outline& outline, const Pose2& pose) const {
  Room room;
  room.all = world_.clearance(outline, pose, &room.shape);
  room.world = room.all.distance;
  take_room(outline, pose, room);
  return room;
}

Room Surroundings::exact_room_among_bodies(const Outline& outline, const Pose2& pose, double within) const {
  Room room;
  room.all.distance = within;
  take_room(outline, pose, room);
  return room;
}

/// What the bodies leave of the room.
void Surroundings::take_room(const Outline& outline, const Pose2& pose, Room& room) const {
  if (!bodies_) return;
  const auto consider = [&](std::size_t body) {
    if (left_out(body)) return;
    const double radii = outline.circumradius() + bodies_->radius(body);
    if ((bodies_->center(body) - pose.position()).norm() - radii > room.all.distance + doubt) return;
    const Clearance found = clearance(*bodies_, body, outline, pose);
    if (found.distance > room.all.distance) return;
    if (found.distance == room.all.distance && (!room.other || bodies_->name(body) >= *room.other)) return;
    room.all = found;
    room.other = &bodies_->name(body);
    room.body = body;
  };
  // Nobody farther away than the nearest so far matters. Where nothing is near, the search grows.
  const double radii = outline.circumradius() + bodies_->largest_radius() + doubt;
  constexpr double usual = 1.0;  // m
  for (double reach = std::min(usual, room.all.distance);; reach *= 2.0) {
    const Vector2 extent = Vector2::Constant(std::min(reach, room.all.distance) + radii);
    const bool all = bodies_->visit_box(pose.position() - extent, pose.position() + extent, consider);
    if (all || room.all.distance <= reach) return;
  }
}

bool Surroundings::still_in_the_way(const Room& room, const Outline& outline, const Pose2& pose, double within) const {
  if (room.other) return clearance(*bodies_, room.body, outline, pose).distance <= within;
  return room.shape.map && room.shape.map->clearance({outline, pose}, room.shape.id).distance <= within;
}

double Surroundings::room_among_bodies(const Outline& outline, const Pose2& pose, double within) const {
  double room = infinity;
  if (!bodies_) return room;
  const Vector2 extent = Vector2::Constant(within + outline.circumradius() + bodies_->largest_radius() + doubt);
  bodies_->visit_box(pose.position() - extent, pose.position() + extent, [&](std::size_t body) {
    if (left_out(body)) return;
    const double radii = outline.circumradius() + bodies_->radius(body);
    room = std::min(room, (bodies_->center(body) - pose.position()).norm() - radii);
  });
  return room;
}

void Surroundings::cast(const Vector2& origin, std::span<const Vector2> directions, double range,
                        std::span<RayHit> hits) const {
  assert(std::isfinite(range));
  world_.cast(origin, directions, range, hits);
  if (!bodies_ || directions.empty()) return;

  // Only bodies that reach into the box around all rays, as far as the world lets them go, can be met.
  Vector2 low = origin, high = origin;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Vector2 end = origin + std::min(range, hits[i].distance) * directions[i];
    low = low.cwiseMin(end);
    high = high.cwiseMax(end);
  }
  const Vector2 extent = Vector2::Constant(bodies_->largest_radius() + doubt);
  const Bundle bundle(directions);
  bodies_->visit_box(low - extent, high + extent, [&](std::size_t body) {
    if (left_out(body)) return;
    const Vector2 to_center = bodies_->center(body) - origin;
    const double radius = bodies_->radius(body);
    bundle.visit_towards(to_center, radius, [&](std::size_t i) {
      const Ray ray{origin, directions[i]};
      const double along = to_center.dot(ray.direction);
      if (along < -radius || along - radius > std::min(range, hits[i].distance)) return;
      if (std::abs(cross(ray.direction, to_center)) > radius) return;
      const std::span<const Vector2> corners = bodies_->corners(body);
      std::size_t met = corners.size();
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const double distance = hit_distance(ray, edge(corners, k));
        if (!(distance < hits[i].distance && distance <= range)) continue;
        hits[i].distance = distance;
        met = k;
      }
      if (met < corners.size()) hits[i].normal = hit_normal(ray, edge(corners, met));
    });
  });
}

}  // namespace kervan::sim
