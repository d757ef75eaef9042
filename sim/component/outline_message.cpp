#include "sim/component/outline_message.hpp"

#include <span>

#include "framework/geometry/messages.hpp"

namespace kervan::sim {

kervan_msgs::msg::Outline outline_message(const World& world, Time stamp) {
  kervan_msgs::msg::Outline outline;
  geometry::set_header(outline.header, stamp, "map");
  const auto draw = [&outline](std::span<const Segment> segments) {
    for (const Segment& s : segments) {
      auto& drawn = outline.segments.emplace_back();
      drawn.x1 = s.a.x();
      drawn.y1 = s.a.y();
      drawn.x2 = s.b.x();
      drawn.y2 = s.b.y();
    }
  };
  draw(world.segments());
  for (const CellMap& map : world.bitmaps()) draw(map.edges().segments());
  for (const Circle& c : world.circles()) {
    auto& drawn = outline.circles.emplace_back();
    drawn.x = c.center.x();
    drawn.y = c.center.y();
    drawn.radius = c.radius;
  }
  for (const Box& box : world.boxes()) {
    auto& drawn = outline.polygons.emplace_back();
    for (const Vector2& corner : corners(box)) {
      auto& point = drawn.corners.emplace_back();
      point.x = static_cast<float>(corner.x());
      point.y = static_cast<float>(corner.y());
    }
  }
  return outline;
}

}  // namespace kervan::sim
