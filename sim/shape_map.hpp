/// Segments and discs that never move, and exact questions about all of them at once. Metres, in the frame `map`.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/outline.hpp"
#include "sim/shape_grid.hpp"

namespace kervan::sim {

/// Where a ray meets an obstacle.
struct RayHit {
  double distance = infinity;        ///< m from the ray's origin; infinity if it meets nothing
  Vector2 normal = Vector2::Zero();  ///< of the surface, length 1, on the ray's side
};

/// Whether the normals of hits are of interest; where they are not, they need not be what they should.
enum class Normals { wanted, unwanted };

/// The point of all obstacles that is nearest to a given one.
struct NearestObstacle {
  double distance = infinity;       ///< m; 0 inside a solid, infinity if there is none
  Vector2 point = Vector2::Zero();  ///< on the surface, or the given point itself inside a solid
};

/// A body at a place in map, for questions that are answered in its own frame.
class PlacedOutline {
 public:
  PlacedOutline(const Outline& outline, const Pose2& pose)
      : outline_(outline), center_(pose.position()), c_(std::cos(pose.yaw)), s_(std::sin(pose.yaw)) {}

  const Outline& outline() const { return outline_; }
  const Vector2& center() const { return center_; }
  Vector2 to_body(const Vector2& p) const {
    const Vector2 d = p - center_;
    return {c_ * d.x() + s_ * d.y(), c_ * d.y() - s_ * d.x()};
  }
  Vector2 to_map(const Vector2& p) const {
    return {center_.x() + c_ * p.x() - s_ * p.y(), center_.y() + s_ * p.x() + c_ * p.y()};
  }

 private:
  const Outline& outline_;
  Vector2 center_;
  double c_, s_;
};

class ShapeMap {
 public:
  /// Every number is finite, every radius positive.
  ShapeMap(std::vector<Segment> segments, std::vector<Circle> circles);

  bool empty() const { return segments_.empty() && circles_.empty(); }

  /// The first shape along the ray; a hit that is nearer than `range`, or at it, comes into `best` if it is nearer.
  void cast(const Ray& ray, double range, RayHit& best) const;

  /// The nearest point of all shapes comes into `best` if it is nearer. It is looked for as far as `range`.
  void nearest(const Vector2& point, double range, NearestObstacle& best) const;

  /// The same for the clearance of a body; the points in its frame. `id` becomes that of the shape, if it is one of
  /// these.
  void clearance(const PlacedOutline& body, Clearance& best, std::uint32_t& id) const;

  /// The clearance to the shape with the number `id` alone.
  Clearance clearance(const PlacedOutline& body, std::uint32_t id) const;

  std::span<const Segment> segments() const { return segments_; }
  std::span<const Circle> circles() const { return circles_; }

 private:
  std::vector<Segment> segments_;
  std::vector<Circle> circles_;
  ShapeGrid grid_;
};

/// One shape of a map; none if `map` is null.
struct ShapeRef {
  const ShapeMap* map = nullptr;
  std::uint32_t id = 0;
};

}  // namespace kervan::sim
