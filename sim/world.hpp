/// A world: what never moves in it, and the scripts of what does. Immutable, so that any number of robots and threads
/// may ask it at once. Everything is in the frame `map`, in metres and radians.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/bitmap.hpp"
#include "sim/cell_map.hpp"
#include "sim/moving_obstacle.hpp"
#include "sim/outline.hpp"
#include "sim/shape_map.hpp"

namespace kervan::sim {

struct Shapes {
  std::vector<Segment> segments = {};
  std::vector<Circle> circles = {};
  std::vector<Box> boxes = {};
};

/// What a world is made of, as its file gives it.
struct Obstacles {
  std::vector<Segment> segments = {};
  std::vector<Circle> circles = {};
  std::vector<Box> boxes = {};
  std::vector<Bitmap> bitmaps = {};
  Shapes low = {};  ///< too low for sonars and lasers: only bodies meet them
  std::vector<MovingObstacle> moving = {};
};

/// Shapes that never move, made ready for questions.
class Solids {
 public:
  explicit Solids(Shapes shapes);

  /// As they were given, in the same order.
  std::span<const Segment> segments() const {
    return map_.segments().first(map_.segments().size() - 4 * boxes_.size());
  }
  std::span<const Circle> circles() const { return map_.circles(); }
  std::span<const Box> boxes() const { return boxes_; }

  /// All of them: with the four edges of each box behind the segments.
  const ShapeMap& map() const { return map_; }

  /// True if the point lies in a box: a body may lie wholly in one and touch none of its edges.
  bool in_box(const Vector2& point) const;

 private:
  std::vector<Box> boxes_;
  ShapeMap map_;
};

class World {
 public:
  /// Throws std::invalid_argument if a number is not finite, a segment or a box has no extent, a radius is not
  /// positive, a bitmap does not have as many cells as it says, or a moving obstacle cannot be (require_valid) or has
  /// the name of another one. A world without obstacles is allowed.
  explicit World(Obstacles obstacles, std::string name = {});

  /// The first obstacle along the ray, no farther than `range`; nothing if there is none. Low ones are passed over.
  /// Exact among shapes; as exact as CellMap says among the cells of bitmaps.
  std::optional<RayHit> cast(const Ray& ray, double range = infinity) const;

  /// The same for up to most_rays of them: `hits` is where those of the fans end, one after the other; there are as
  /// many. Throws std::invalid_argument if there are too many.
  void cast(std::span<const RayFan> fans, double range, std::span<RayHit> hits,
            Normals normals = Normals::wanted) const;

  /// The nearest obstacle to a point, low or not, no farther than `range`; nothing if there is none. Exact.
  std::optional<NearestObstacle> nearest(const Vector2& point, double range = infinity) const;

  /// No more than the distance from the point to the nearest obstacle, low or not; quick. Often 0 where obstacles are
  /// no bitmaps.
  double free_around(const Vector2& point) const;

  /// How much room a body has at `pose`: 0 when it touches or overlaps an obstacle, low or not, infinity in a world
  /// without any. Exact; a body that lies wholly inside a solid overlaps it. `nearest` becomes the shape that takes the
  /// room, or none.
  Clearance clearance(const Outline& outline, const Pose2& pose, ShapeRef* nearest = nullptr) const;

  const std::string& name() const { return name_; }

  /// What the world was made of, in the same order.
  std::span<const Segment> segments() const { return tall_.segments(); }
  std::span<const Circle> circles() const { return tall_.circles(); }
  std::span<const Box> boxes() const { return tall_.boxes(); }
  std::span<const CellMap> bitmaps() const { return bitmaps_; }
  const Solids& tall() const { return tall_; }
  const Solids& low() const { return low_; }
  std::span<const MovingObstacle> moving() const { return moving_; }

 private:
  World(std::string name, Obstacles valid_obstacles);
  bool solid_at(const Vector2& point) const;

  std::string name_;
  Solids tall_;
  Solids low_;
  std::vector<CellMap> bitmaps_;
  std::vector<MovingObstacle> moving_;
};

}  // namespace kervan::sim
