#include "sim/world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace kervan::sim {

namespace {

Obstacles valid(Obstacles obstacles) {
  for (const Segment& s : obstacles.segments)
    if (!s.a.allFinite() || !s.b.allFinite() || s.a == s.b)
      throw std::invalid_argument("a segment needs two different, finite ends");
  for (const Circle& c : obstacles.circles)
    if (!c.center.allFinite() || !std::isfinite(c.radius) || c.radius <= 0.0)
      throw std::invalid_argument("a circle needs a finite centre and a positive radius");
  for (const Box& b : obstacles.boxes)
    if (!b.pose.position().allFinite() || !std::isfinite(b.pose.yaw) || !b.size.allFinite() ||
        !(b.size.minCoeff() > 0.0))
      throw std::invalid_argument("a box needs a finite pose and a positive size");
  return obstacles;
}

std::vector<Segment> with_box_edges(std::vector<Segment> segments, const std::vector<Box>& boxes) {
  for (const Box& box : boxes) {
    const auto c = corners(box);
    for (std::size_t i = 0; i < 4; ++i) segments.push_back({c[i], c[(i + 1) % 4]});
  }
  return segments;
}

/// A question about a neighbourhood meets a shape in several cells; this remembers the latest ones, so that most of the
/// repetitions cost nothing. Asking twice is harmless.
class Recent {
 public:
  bool has_or_add(std::uint32_t id) {
    if (std::find(ids_.begin(), ids_.end(), id) != ids_.end()) return true;
    ids_[next_++ % ids_.size()] = id;
    return false;
  }

 private:
  std::array<std::uint32_t, 8> ids_{~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u};
  std::size_t next_ = 0;
};

}  // namespace

World::World(Obstacles obstacles, std::string name) : World(std::move(name), valid(std::move(obstacles))) {}

World::World(std::string name, Obstacles valid_obstacles)
    : name_(std::move(name)),
      segments_(with_box_edges(std::move(valid_obstacles.segments), valid_obstacles.boxes)),
      circles_(std::move(valid_obstacles.circles)),
      boxes_(std::move(valid_obstacles.boxes)),
      grid_(segments_, circles_) {}

std::optional<RayHit> World::cast(const Ray& ray, double range) const {
  double best = infinity;
  std::uint32_t best_id = 0;
  grid_.walk(ray, range, [&](ShapeGrid::Ids ids, double exit) {
    for (const std::uint32_t id : ids) {
      const double distance =
          id < segments_.size() ? hit_distance(ray, segments_[id]) : hit_distance(ray, circles_[id - segments_.size()]);
      if (distance < best) {
        best = distance;
        best_id = id;
      }
    }
    return best <= exit;
  });
  if (!(best <= range) || best == infinity) return std::nullopt;
  return RayHit{best, best_id < segments_.size() ? hit_normal(ray, segments_[best_id])
                                                 : hit_normal(ray, circles_[best_id - segments_.size()], best)};
}

std::optional<NearestObstacle> World::nearest(const Vector2& point, double range) const {
  for (const Box& box : boxes_)
    if (contains(box, point)) return NearestObstacle{0.0, point};
  NearestObstacle best{infinity, point};
  // Whatever lies outside of the box searched is farther than `reach`, so a find nearer than that is the nearest of
  // all.
  for (double reach = grid_.cell_size();; reach *= 2.0) {
    Recent recent;
    const Vector2 extent = Vector2::Constant(std::min(reach, range));
    const bool all = grid_.visit_box(point - extent, point + extent, [&](ShapeGrid::Ids ids) {
      for (const std::uint32_t id : ids) {
        if (recent.has_or_add(id)) continue;
        const Vector2 near = id < segments_.size() ? nearest_point(segments_[id], point)
                                                   : nearest_point(circles_[id - segments_.size()], point);
        const double distance = (near - point).norm();
        if (distance < best.distance) best = {distance, near};
      }
    });
    if (all || best.distance <= reach || reach >= range) break;
  }
  if (best.distance > range || best.distance == infinity) return std::nullopt;
  return best;
}

Clearance World::clearance(const Outline& outline, const Pose2& pose) const {
  const Vector2 center = pose.position();
  for (const Box& box : boxes_)
    if (contains(box, center)) return {0.0, center, center};

  // The shapes are brought into the body's frame, one by one as they are met.
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  const auto to_body = [&](const Vector2& p) {
    const Vector2 d = p - center;
    return Vector2(c * d.x() + s * d.y(), c * d.y() - s * d.x());
  };
  const auto to_map = [&](const Vector2& p) {
    return Vector2(center.x() + c * p.x() - s * p.y(), center.y() + s * p.x() + c * p.y());
  };
  Clearance best;
  for (double reach = grid_.cell_size();; reach *= 2.0) {
    Recent recent;
    const Vector2 extent = Vector2::Constant(outline.circumradius() + reach);
    const bool all = grid_.visit_box(center - extent, center + extent, [&](ShapeGrid::Ids ids) {
      for (const std::uint32_t id : ids) {
        if (recent.has_or_add(id)) continue;
        const Clearance found = [&] {
          if (id < segments_.size())
            return outline.clearance(Segment{to_body(segments_[id].a), to_body(segments_[id].b)});
          const Circle& circle = circles_[id - segments_.size()];
          return outline.clearance(Circle{to_body(circle.center), circle.radius});
        }();
        if (found.distance < best.distance) best = found;
      }
    });
    if (all || best.distance <= reach) break;
  }
  if (best.distance == infinity) return best;
  best.on_obstacle = to_map(best.on_obstacle);
  best.on_outline = to_map(best.on_outline);
  return best;
}

}  // namespace kervan::sim
