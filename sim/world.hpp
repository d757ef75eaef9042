/// The part of a world that never moves. Immutable, so that any number of robots and threads may ask it at once.
/// Everything is in the frame `map`, in metres and radians.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/outline.hpp"
#include "sim/shape_grid.hpp"
#include "sim/shapes.hpp"

namespace kervan::sim {

/// What a world is made of, as its file gives it.
struct Obstacles {
  std::vector<Segment> segments = {};
  std::vector<Circle> circles = {};
  std::vector<Box> boxes = {};
};

/// Where a ray meets an obstacle.
struct RayHit {
  double distance;  ///< m from the ray's origin
  Vector2 normal;   ///< of the surface, length 1, on the ray's side
};

/// The point of all obstacles that is nearest to a given one.
struct NearestObstacle {
  double distance;  ///< m; 0 inside a solid
  Vector2 point;    ///< on the surface, or the given point itself inside a solid
};

class World {
 public:
  /// Throws std::invalid_argument if a number is not finite, a segment or a box has no extent, or a radius is not
  /// positive. A world without obstacles is allowed.
  explicit World(Obstacles obstacles, std::string name = {});

  /// The first obstacle along the ray, no farther than `range`; nothing if there is none. Exact.
  std::optional<RayHit> cast(const Ray& ray, double range = infinity) const;

  /// The nearest obstacle to a point, no farther than `range`; nothing if there is none. Exact.
  std::optional<NearestObstacle> nearest(const Vector2& point, double range = infinity) const;

  /// How much room a body has at `pose`: 0 when it touches or overlaps an obstacle, infinity in a world without any.
  /// Exact; a body that lies wholly inside a solid overlaps it.
  Clearance clearance(const Outline& outline, const Pose2& pose) const;

  const std::string& name() const { return name_; }

  /// What the world was made of, in the same order.
  std::span<const Segment> segments() const { return {segments_.data(), segments_.size() - 4 * boxes_.size()}; }
  std::span<const Circle> circles() const { return circles_; }
  std::span<const Box> boxes() const { return boxes_; }

 private:
  World(std::string name, Obstacles valid_obstacles);

  std::string name_;
  std::vector<Segment> segments_;  // with the four edges of each box at the end
  std::vector<Circle> circles_;
  std::vector<Box> boxes_;
  ShapeGrid grid_;
};

}  // namespace kervan::sim
