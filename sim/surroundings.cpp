#include "sim/surroundings.hpp"

#include <algorithm>
#include <array>
#include <bit>
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

/// The rays of some fans as RayPaths, from the origin of the first. In single precision, to find out quickly which rays
/// are worth asking about.
class Paths {
 public:
  Paths(std::span<const RayFan> fans, double range, std::span<const RayHit> hits) : from_(fans[0].origin) {
    std::size_t i = 0;
    for (const RayFan& fan : fans) {
      const auto x = static_cast<float>(fan.origin.x() - from_.x()), y = static_cast<float>(fan.origin.y() - from_.y());
      for (const Vector2& direction : fan.directions) {
        fan_[i] = &fan;
        direction_[i] = &direction;
        x_[i] = x;
        y_[i] = y;
        dx_[i] = static_cast<float>(direction.x());
        dy_[i] = static_cast<float>(direction.y());
        length_[i] = static_cast<float>(std::min(range, hits[i].distance));
        ++i;
      }
    }
    for (count_ = i; i % 16 != 0; ++i) x_[i] = y_[i] = dx_[i] = dy_[i] = length_[i] = 0.0f;
    slack_ = 1e-5 * (1.0 + range);
  }

  /// Calls visit(i, ray) for all rays that pass within `radius` of the point, and perhaps for some that do so nearly.
  /// Each returns how far the ray goes from now on.
  template <class Visit>
  void visit_near(const Vector2& point, double radius, Visit&& visit) {
    std::array<std::uint16_t, most_rays / 16> near;
    const RayPaths paths{x_.data(),  y_.data(),      dx_.data(),
                         dy_.data(), length_.data(), static_cast<std::int32_t>((count_ + 15) / 16 * 16)};
    const Vector2 to_point = point - from_;
    find_near(paths, static_cast<float>(to_point.x()), static_cast<float>(to_point.y()),
              static_cast<float>(radius + slack_), near.data(), instructions_);
    for (std::size_t first = 0, k = 0; first < count_; first += 16, ++k)
      for (unsigned rays = near[k]; rays != 0; rays &= rays - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(rays));
        if (i < count_) length_[i] = static_cast<float>(visit(i, Ray{fan_[i]->origin, *direction_[i]}));
      }
  }

 private:
  Vector2 from_;
  Instructions instructions_ = widest();
  double slack_;  // m; more than the rounding of what is not much farther away than the rays reach
  std::size_t count_;
  std::array<const RayFan*, most_rays> fan_;
  std::array<const Vector2*, most_rays> direction_;
  std::array<float, most_rays> x_, y_, dx_, dy_, length_;
};

/// A body that stands among others.
class Standing {
 public:
  Standing(const Outline& outline, const Pose2& pose) : outline_(outline), pose_(pose) {}

  /// No more than its distance to one of `bodies`; quick. May be negative. Beyond `within` it is any number from there
  /// on.
  double separation(const Bodies& bodies, std::size_t other, double within) {
    const Vector2 apart = bodies.center(other) - pose_.position();
    const double distance = apart.norm(), gap = distance - (outline_.circumradius() + bodies.radius(other));
    if (gap >= within || distance == 0.0) return gap;
    // Bodies are no discs: seen along the line between the centres they often reach less far.
    if (!turned_) {
      c_ = std::cos(pose_.yaw);
      s_ = std::sin(pose_.yaw);
      turned_ = true;
    }
    const Vector2 axis = apart / distance;
    const Vector2 in_body(c_ * axis.x() + s_ * axis.y(), c_ * axis.y() - s_ * axis.x());
    double reach = -infinity, other_reach = -infinity;
    for (const Vector2& corner : outline_.corners()) reach = std::max(reach, corner.dot(in_body));
    for (const Vector2& corner : bodies.corners(other))
      other_reach = std::max(other_reach, (bodies.center(other) - corner).dot(axis));
    return distance - reach - other_reach - doubt;
  }

 private:
  const Outline& outline_;
  const Pose2& pose_;
  bool turned_ = false;
  double c_ = 1.0, s_ = 0.0;
};

/// Where the ray meets the edge of a body, if it is nearer than `best` and no farther than `range`, comes into `best`.
void meet(const Ray& ray, std::span<const Vector2> corners, double range, Normals normals, RayHit& best) {
  // An edge is worth asking about if its ends do not both lie well on the same side of the ray. Which ones are is found
  // out without a branch for each: no processor could guess it.
  constexpr double well = 1e-6;      // m
  constexpr std::size_t edges = 31;  // at a time; with the corner at the end of the last they make 32 bits
  std::size_t met = corners.size();
  for (std::size_t first = 0; first < corners.size(); first += edges) {
    const std::size_t count = std::min(edges, corners.size() - first);
    std::uint32_t left = 0, right = 0;  // the corners that are not well on the other side
    for (std::size_t k = 0; k <= count; ++k) {
      const Vector2& corner = corners[first + k < corners.size() ? first + k : 0];
      const double side = cross(ray.direction, corner - ray.origin);
      left |= static_cast<std::uint32_t>(side >= -well) << k;
      right |= static_cast<std::uint32_t>(side <= well) << k;
    }
    const std::uint32_t all = (std::uint32_t{1} << count) - 1;
    for (std::uint32_t ask = (left | left >> 1) & (right | right >> 1) & all; ask != 0; ask &= ask - 1) {
      const std::size_t k = first + static_cast<std::size_t>(std::countr_zero(ask));
      const double distance = hit_distance(ray, edge(corners, k));
      if (distance < best.distance && distance <= range) {
        best.distance = distance;
        met = k;
      }
    }
  }
  if (met < corners.size() && normals == Normals::wanted) best.normal = hit_normal(ray, edge(corners, met));
}

}  // namespace

Clearance clearance(const Bodies& bodies, std::size_t other, const Outline& outline, const Pose2& pose, double within) {
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
  Segment side{in_body(corners.back()), in_body(corners.back())};
  for (const Vector2& corner : corners) {
    side = {side.b, in_body(corner)};
    if (outline.separation(side) > std::min(nearest.distance, within) + doubt) continue;
    const Clearance found = outline.clearance(side);
    if (found.distance < nearest.distance) nearest = found;
  }
  nearest.on_obstacle = pose * nearest.on_obstacle;
  nearest.on_outline = pose * nearest.on_outline;
  return nearest;
}

Room Surroundings::room(const Outline& outline, const Pose2& pose) const {
  Room room;
  room.all = world_->clearance(outline, pose, &room.shape);
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
  Standing here(outline, pose);
  const auto consider = [&](std::size_t body) {
    if (left_out(body)) return;
    if (here.separation(*bodies_, body, room.all.distance + doubt) > room.all.distance + doubt) return;
    const Clearance found = clearance(*bodies_, body, outline, pose, room.all.distance);
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
  if (room.other) return clearance(*bodies_, room.body, outline, pose, within).distance <= within;
  return room.shape.map && room.shape.map->clearance({outline, pose}, room.shape.id).distance <= within;
}

double Surroundings::room_among_bodies(const Outline& outline, const Pose2& pose, double within) const {
  double room = infinity;
  if (!bodies_) return room;
  Standing here(outline, pose);
  const Vector2 extent = Vector2::Constant(within + outline.circumradius() + bodies_->largest_radius() + doubt);
  bodies_->visit_box(pose.position() - extent, pose.position() + extent, [&](std::size_t body) {
    if (!left_out(body)) room = std::min(room, here.separation(*bodies_, body, within));
  });
  return room;
}

void Surroundings::cast(std::span<const RayFan> fans, double range, std::span<RayHit> hits, Normals normals) const {
  world_->cast(fans, range, hits, normals);
  cast_among_bodies(fans, range, hits, normals);
}

void Surroundings::cast_among_bodies(std::span<const RayFan> fans, double range, std::span<RayHit> hits,
                                     Normals normals) const {
  assert(std::isfinite(range));
  if (!bodies_ || hits.empty()) return;

  // Only bodies that reach into the box around all rays, as far as the world lets them go, can be met.
  Vector2 low = fans[0].origin, high = low;
  const RayHit* hit = hits.data();
  for (const RayFan& fan : fans)
    for (const Vector2& direction : fan.directions) {
      const Vector2 end = fan.origin + std::min(range, (hit++)->distance) * direction;
      low = low.cwiseMin(end).cwiseMin(fan.origin);
      high = high.cwiseMax(end).cwiseMax(fan.origin);
    }
  const Vector2 extent = Vector2::Constant(bodies_->largest_radius() + doubt);
  Paths paths(fans, range, hits);
  bodies_->visit_box(low - extent, high + extent, [&](std::size_t body) {
    if (left_out(body)) return;
    paths.visit_near(bodies_->center(body), bodies_->radius(body), [&](std::size_t i, const Ray& ray) {
      meet(ray, bodies_->corners(body), range, normals, hits[i]);
      return std::min(range, hits[i].distance);
    });
  });
}

}  // namespace kervan::sim
