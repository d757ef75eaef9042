#include "sim/component/outline_message.hpp"

#include "framework/geometry/messages.hpp"

namespace kervan::sim {

namespace {

using Drawing = kervan_msgs::msg::Outline;

void draw(std::span<const Segment> segments, Drawing& outline) {
  for (const Segment& s : segments) {
    auto& drawn = outline.segments.emplace_back();
    drawn.x1 = s.a.x();
    drawn.y1 = s.a.y();
    drawn.x2 = s.b.x();
    drawn.y2 = s.b.y();
  }
}

void draw(std::span<const Vector2> corners, kervan_msgs::msg::OutlinePolygon& polygon) {
  polygon.corners.clear();
  for (const Vector2& corner : corners) {
    auto& point = polygon.corners.emplace_back();
    point.x = static_cast<float>(corner.x());
    point.y = static_cast<float>(corner.y());
  }
}

void draw(std::span<const Circle> circles, std::span<const Box> boxes, Drawing& outline) {
  for (const Circle& c : circles) {
    auto& drawn = outline.circles.emplace_back();
    drawn.x = c.center.x();
    drawn.y = c.center.y();
    drawn.radius = c.radius;
  }
  for (const Box& box : boxes) draw(corners(box), outline.polygons.emplace_back());
}

}  // namespace

Drawing outline_message(const World& world, Time stamp) {
  Drawing outline;
  geometry::set_header(outline.header, stamp, "map");
  draw(world.segments(), outline);
  draw(world.low().segments(), outline);
  for (const CellMap& map : world.bitmaps()) draw(map.edges().segments(), outline);
  draw(world.circles(), world.boxes(), outline);
  draw(world.low().circles(), world.low().boxes(), outline);
  return outline;
}

void set_outlines(std::span<const MovingBody> bodies, Time stamp, Drawing& outline) {
  geometry::set_header(outline.header, stamp, "map");
  outline.polygons.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    std::vector<Vector2> placed;
    for (const Vector2& corner : bodies[i].obstacle().outline.corners()) placed.push_back(bodies[i].pose() * corner);
    draw(placed, outline.polygons[i]);
  }
}

}  // namespace kervan::sim
