#include "sim/files/world_file.hpp"

#include <utility>

#include "framework/config/node.hpp"
#include "sim/files/ranges.hpp"

namespace kervan::sim {

namespace {

Segment segment(const config::Node& node) {
  const auto& ends = node.list_of(2, "the two ends of a segment [[x m, y m], [x m, y m]]");
  const Segment segment{point_within(ends[0], farthest), point_within(ends[1], farthest)};
  if (segment.a == segment.b) node.fail("both ends of the segment are the same point; a segment needs a length");
  return segment;
}

Circle circle(const config::Node& node) {
  node.only_keys({"center", "radius"});
  return {point_within(node.required("center"), farthest), positive(node.required("radius"), "m", farthest)};
}

Box box(const config::Node& node) {
  node.only_keys({"center", "size", "yaw"});
  const Vector2 center = point_within(node.required("center"), farthest);
  const auto& size = node.required("size").list_of(2, "the extents of a box [along x m, along y m]");
  const config::Node* yaw = node.optional("yaw");
  return {{center.x(), center.y(), yaw ? yaw->as_quantity("rad") : 0.0},
          {positive(size[0], "m", farthest), positive(size[1], "m", farthest)}};
}

template <class Shape>
std::vector<Shape> shapes(const config::Node& file, std::string_view key, Shape (*read)(const config::Node&)) {
  std::vector<Shape> result;
  if (const config::Node* list = file.optional(key))
    for (const config::Node& item : list->list()) result.push_back(read(item));
  return result;
}

World world(const config::Node& file) {
  file.only_keys({"kervan_world", "name", "segments", "circles", "boxes"});
  require_version_1(file, "kervan_world");
  const std::string name = file.required("name").as_text();
  return World({shapes(file, "segments", segment), shapes(file, "circles", circle), shapes(file, "boxes", box)}, name);
}

}  // namespace

World load_world(const std::string& path) { return world(config::load(path)); }

World parse_world(const std::string& text, const std::string& shown_as) { return world(config::parse(text, shown_as)); }

}  // namespace kervan::sim
