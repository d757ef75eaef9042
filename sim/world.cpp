#include "sim/world.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

namespace kervan::sim {

namespace {

void require_valid(std::span<const Segment> segments, std::span<const Circle> circles, std::span<const Box> boxes) {
  for (const Segment& s : segments)
    if (!s.a.allFinite() || !s.b.allFinite() || s.a == s.b)
      throw std::invalid_argument("a segment needs two different, finite ends");
  for (const Circle& c : circles)
    if (!c.center.allFinite() || !std::isfinite(c.radius) || c.radius <= 0.0)
      throw std::invalid_argument("a circle needs a finite centre and a positive radius");
  for (const Box& b : boxes)
    if (!b.pose.position().allFinite() || !std::isfinite(b.pose.yaw) || !b.size.allFinite() ||
        !(b.size.minCoeff() > 0.0))
      throw std::invalid_argument("a box needs a finite pose and a positive size");
}

Obstacles valid(Obstacles obstacles) {
  require_valid(obstacles.segments, obstacles.circles, obstacles.boxes);
  require_valid(obstacles.low.segments, obstacles.low.circles, obstacles.low.boxes);
  for (const Bitmap& b : obstacles.bitmaps) sim::require_valid(b);
  std::set<std::string> names;
  for (const MovingObstacle& m : obstacles.moving) {
    sim::require_valid(m);
    if (!names.insert(m.name).second) throw std::invalid_argument("two moving obstacles have the name " + m.name);
  }
  return obstacles;
}

std::vector<Segment> with_box_edges(std::vector<Segment> segments, const std::vector<Box>& boxes) {
  for (const Box& box : boxes) {
    const auto c = corners(box);
    for (std::size_t i = 0; i < 4; ++i) segments.push_back({c[i], c[(i + 1) % 4]});
  }
  return segments;
}

}  // namespace

Solids::Solids(Shapes shapes)
    : boxes_(std::move(shapes.boxes)),
      map_(with_box_edges(std::move(shapes.segments), boxes_), std::move(shapes.circles)) {}

bool Solids::in_box(const Vector2& point) const {
  return std::any_of(boxes_.begin(), boxes_.end(), [&](const Box& box) { return contains(box, point); });
}

World::World(Obstacles obstacles, std::string name) : World(std::move(name), valid(std::move(obstacles))) {}

World::World(std::string name, Obstacles valid_obstacles)
    : name_(std::move(name)),
      tall_(
          {std::move(valid_obstacles.segments), std::move(valid_obstacles.circles), std::move(valid_obstacles.boxes)}),
      low_(std::move(valid_obstacles.low)),
      bitmaps_(valid_obstacles.bitmaps.begin(), valid_obstacles.bitmaps.end()),
      moving_(std::move(valid_obstacles.moving)) {}

bool World::solid_at(const Vector2& point) const {
  return tall_.in_box(point) || low_.in_box(point) ||
         std::any_of(bitmaps_.begin(), bitmaps_.end(), [&](const CellMap& map) { return map.solid_at(point); });
}

std::optional<RayHit> World::cast(const Ray& ray, double range) const {
  RayHit hit;
  const RayFan fan{ray.origin, {&ray.direction, 1}};
  cast({&fan, 1}, range, {&hit, 1});
  if (hit.distance == infinity) return std::nullopt;
  return hit;
}

void World::cast(std::span<const RayFan> fans, double range, std::span<RayHit> hits, Normals normals) const {
  if (hits.size() > most_rays) throw std::invalid_argument("too many rays at once");
  std::fill(hits.begin(), hits.end(), RayHit{});
  std::array<float, most_rays> distances;
  std::array<std::int32_t, most_rays> faces;
  constexpr std::size_t few = 2;  // are done before wide registers are filled
  for (const CellMap& map : bitmaps_) {
    map.cast(fans, range, {distances.data(), hits.size()}, {faces.data(), hits.size()},
             hits.size() <= few ? Instructions::scalar : widest());
    std::size_t i = 0;
    for (const RayFan& fan : fans)
      for (const Vector2& direction : fan.directions) {
        const double distance = distances[i];
        if (distance < hits[i].distance && distance <= range) {
          hits[i].distance = distance;
          if (normals == Normals::wanted) hits[i].normal = map.normal(direction, faces[i]);
        }
        ++i;
      }
  }
  if (tall_.map().empty()) return;
  RayHit* hit = hits.data();
  for (const RayFan& fan : fans)
    for (const Vector2& direction : fan.directions) tall_.map().cast({fan.origin, direction}, range, *hit++);
}

std::optional<NearestObstacle> World::nearest(const Vector2& point, double range) const {
  if (solid_at(point)) return NearestObstacle{0.0, point};
  NearestObstacle best;
  tall_.map().nearest(point, range, best);
  low_.map().nearest(point, range, best);
  for (const CellMap& map : bitmaps_) map.edges().nearest(point, range, best);
  if (best.distance > range || best.distance == infinity) return std::nullopt;
  return best;
}

double World::free_around(const Vector2& point) const {
  if (!tall_.map().empty() || !low_.map().empty()) return 0.0;
  double free = infinity;
  for (const CellMap& map : bitmaps_) free = std::min(free, map.free_around(point));
  return free;
}

Clearance World::clearance(const Outline& outline, const Pose2& pose, ShapeRef* nearest) const {
  const PlacedOutline body(outline, pose);
  if (nearest) *nearest = {};
  if (solid_at(body.center())) return {0.0, body.center(), body.center()};
  Clearance best;
  const auto ask = [&](const ShapeMap& map) {
    const double before = best.distance;
    std::uint32_t id = 0;
    map.clearance(body, best, id);
    if (nearest && best.distance < before) *nearest = {&map, id};
  };
  ask(tall_.map());
  ask(low_.map());
  for (const CellMap& map : bitmaps_) ask(map.edges());
  if (best.distance == infinity) return best;
  best.on_obstacle = body.to_map(best.on_obstacle);
  best.on_outline = body.to_map(best.on_outline);
  return best;
}

}  // namespace kervan::sim
