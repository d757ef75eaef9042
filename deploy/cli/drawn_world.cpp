#include "deploy/cli/drawn_world.hpp"

#include <span>

namespace kervan::cli {
namespace {

void add(std::span<const sim::Segment> segments, observe::DrawnWorld& drawn) {
  for (const sim::Segment& segment : segments) drawn.walls.push_back({segment.a, segment.b});
}

void add(const sim::Solids& solids, observe::DrawnWorld& drawn) {
  add(solids.segments(), drawn);
  for (const sim::Circle& circle : solids.circles()) drawn.circles.push_back({circle.center, circle.radius});
  for (const sim::Box& box : solids.boxes()) {
    const auto corners = sim::corners(box);
    drawn.polygons.emplace_back(corners.begin(), corners.end());
  }
}

}  // namespace

observe::DrawnWorld drawn_plan(const sim::World& world) {
  observe::DrawnWorld walls;
  add(world.segments(), walls);
  for (const sim::CellMap& map : world.bitmaps()) add(map.edges().segments(), walls);
  return walls;
}

observe::DrawnWorld drawn(const sim::World& world) {
  observe::DrawnWorld drawn;
  add(world.tall(), drawn);
  add(world.low(), drawn);
  for (const sim::CellMap& map : world.bitmaps()) add(map.edges().segments(), drawn);
  for (const sim::MovingObstacle& obstacle : world.moving()) {
    observe::Polyline corners;
    for (const auto& corner : obstacle.outline.corners()) corners.push_back(obstacle.path.front().pose * corner);
    drawn.polygons.push_back(std::move(corners));
  }
  return drawn;
}

}  // namespace kervan::cli
