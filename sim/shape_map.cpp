#include "sim/shape_map.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace kervan::sim {

namespace {

/// More than the rounding of the distances that are compared with it.
constexpr double doubt = 1e-9;

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

ShapeMap::ShapeMap(std::vector<Segment> segments, std::vector<Circle> circles)
    : segments_(std::move(segments)), circles_(std::move(circles)), grid_(segments_, circles_) {}

void ShapeMap::cast(const Ray& ray, double range, RayHit& best) const {
  double nearest = infinity;
  std::uint32_t nearest_id = 0;
  grid_.walk(ray, std::min(range, best.distance), [&](ShapeGrid::Ids ids, double exit) {
    for (const std::uint32_t id : ids) {
      const double distance =
          id < segments_.size() ? hit_distance(ray, segments_[id]) : hit_distance(ray, circles_[id - segments_.size()]);
      if (distance < nearest) {
        nearest = distance;
        nearest_id = id;
      }
    }
    return nearest <= exit;
  });
  if (!(nearest <= range) || nearest >= best.distance) return;
  best = {nearest, nearest_id < segments_.size() ? hit_normal(ray, segments_[nearest_id])
                                                 : hit_normal(ray, circles_[nearest_id - segments_.size()], nearest)};
}

void ShapeMap::nearest(const Vector2& point, double range, NearestObstacle& best) const {
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
}

Clearance ShapeMap::clearance(const PlacedOutline& body, std::uint32_t id) const {
  if (id < segments_.size())
    return body.outline().clearance(Segment{body.to_body(segments_[id].a), body.to_body(segments_[id].b)});
  const Circle& circle = circles_[id - segments_.size()];
  return body.outline().clearance(Circle{body.to_body(circle.center), circle.radius});
}

void ShapeMap::clearance(const PlacedOutline& body, Clearance& best, std::uint32_t& nearest_id) const {
  struct Candidate {
    double from_center;  // m
    std::uint32_t id;
  };
  const double radius = body.outline().circumradius(), inradius = body.outline().inradius();
  for (double reach = grid_.cell_size();; reach *= 2.0) {
    std::array<Candidate, 256> candidates;
    std::size_t count = 0;
    std::size_t nearest = 0;  // of them to the centre
    // The one that is nearest to the centre is hardly ever much farther from the body than the nearest to that, so most
    // of the others can be left out before they are looked at closely.
    const auto look_closely = [&] {
      if (count == 0) return;
      double enough = std::min(best.distance, std::max(0.0, candidates[nearest].from_center - inradius)) + doubt;
      if (candidates[nearest].from_center <= enough + radius)
        enough = std::min(enough, clearance(body, candidates[nearest].id).distance + doubt);
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t id = candidates[i].id;
        if (candidates[i].from_center > enough + radius) continue;
        if (id < segments_.size()) {
          const Segment segment{body.to_body(segments_[id].a), body.to_body(segments_[id].b)};
          if (body.outline().separation(segment) > enough) continue;
        }
        const Clearance found = clearance(body, id);
        if (found.distance >= best.distance) continue;
        best = found;
        nearest_id = id;
        enough = std::min(enough, best.distance + doubt);
      }
      count = nearest = 0;
    };
    Recent recent;
    const Vector2 extent = Vector2::Constant(radius + reach);
    const bool all = grid_.visit_box(body.center() - extent, body.center() + extent, [&](ShapeGrid::Ids ids) {
      for (const std::uint32_t id : ids) {
        if (recent.has_or_add(id)) continue;
        const Vector2 near = id < segments_.size() ? nearest_point(segments_[id], body.center())
                                                   : nearest_point(circles_[id - segments_.size()], body.center());
        const double from_center = (near - body.center()).norm();
        candidates[count] = {from_center, id};
        if (from_center < candidates[nearest].from_center) nearest = count;
        ++count;
        if (count == candidates.size()) look_closely();
      }
    });
    look_closely();
    if (all || best.distance <= reach) break;
  }
}

}  // namespace kervan::sim
