/// The simulator's outline of the world as it is drawn and judged.
#pragma once

#include <utility>

#include "components/observe/map_drawing.hpp"
#include "kervan_msgs/msg/Outline.hpp"

namespace kervan::observe {

inline DrawnWorld drawn_world(const kervan_msgs::msg::Outline& outline) {
  DrawnWorld world;
  for (const auto& s : outline.segments) world.walls.push_back({{s.x1, s.y1}, {s.x2, s.y2}});
  for (const auto& c : outline.circles) world.circles.push_back({{c.x, c.y}, c.radius});
  for (const auto& polygon : outline.polygons) {
    Polyline corners;
    for (const auto& corner : polygon.corners) corners.emplace_back(corner.x, corner.y);
    world.polygons.push_back(std::move(corners));
  }
  return world;
}

}  // namespace kervan::observe
