#include "sim/files/world_file.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "framework/config/node.hpp"
#include "framework/map_file/image.hpp"
#include "sim/files/aria_map.hpp"
#include "sim/files/ranges.hpp"
#include "sim/files/ros_map.hpp"

namespace kervan::sim {

namespace {

std::string folder_of(const std::string& path) { return std::filesystem::path(path).parent_path().string(); }

std::string path_from(const std::string& folder, const std::string& path) {
  return (std::filesystem::path(folder) / path).string();
}

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

Vector2 extents(const config::Node& size) {
  const auto& both = size.list_of(2, "two extents [along x m, along y m]");
  return {positive(both[0], "m", farthest), positive(both[1], "m", farthest)};
}

/// The keys center, size and yaw of a box or bitmap.
Box rectangle(const config::Node& node) {
  const Vector2 center = point_within(node.required("center"), farthest);
  const Vector2 size = extents(node.required("size"));
  const config::Node* yaw = node.optional("yaw");
  return {{center.x(), center.y(), yaw ? yaw->as_quantity("rad") : 0.0}, size};
}

Box box(const config::Node& node) {
  node.only_keys({"center", "size", "yaw"});
  return rectangle(node);
}

template <class Shape>
std::vector<Shape> shapes(const config::Node& file, std::string_view key, Shape (*read)(const config::Node&)) {
  std::vector<Shape> result;
  if (const config::Node* list = file.optional(key))
    for (const config::Node& item : list->list()) result.push_back(read(item));
  return result;
}

/// A picture laid over a rectangle: its dark half of shades is solid.
Bitmap bitmap(const config::Node& node, const std::string& folder) {
  node.only_keys({"image", "center", "size", "yaw"});
  const Box place = rectangle(node);
  const config::Node& picture = node.required("image");
  const std::string path = path_from(folder, picture.as_text());
  try {
    const map_file::Image image = map_file::load_image(path);
    Bitmap map;
    map.cell = place.size.cwiseQuotient(Vector2(image.columns, image.rows));
    const Vector2 corner = place.pose * Vector2(-0.5 * place.size);
    map.origin = {corner.x(), corner.y(), place.pose.yaw};
    map.columns = image.columns;
    map.rows = image.rows;
    map.solid = map_file::cells_of(
        image, [](map_file::Pixel pixel) -> std::uint8_t { return pixel.opacity == 255 && pixel.shade < 128 ? 1 : 0; });
    return map;
  } catch (const std::invalid_argument& error) {
    picture.fail(path + ": " + error.what());
  }
}

bool is_aria_map(const std::string& path) { return path.ends_with(".map"); }

/// Adds a map of another program.
void add_map(const config::Node& node, const std::string& folder, Obstacles& obstacles) {
  const std::string path = path_from(folder, node.as_text());
  std::string text;
  try {
    text = map_file::read_file(path);
  } catch (const std::invalid_argument& error) {
    node.fail(path + ": " + error.what());
  }
  if (is_aria_map(path)) {
    Obstacles map = parse_aria_map(text, path);
    std::move(map.segments.begin(), map.segments.end(), std::back_inserter(obstacles.segments));
    std::move(map.bitmaps.begin(), map.bitmaps.end(), std::back_inserter(obstacles.bitmaps));
  } else {
    obstacles.bitmaps.push_back(ros_map(config::parse(text, path), folder_of(path)));
  }
}

/// The key `low`: shapes that only bodies meet.
Shapes low_shapes(const config::Node& node) {
  node.only_keys({"segments", "circles", "boxes"});
  return {shapes(node, "segments", segment), shapes(node, "circles", circle), shapes(node, "boxes", box)};
}

Waypoint waypoint(const config::Node& node) {
  node.only_keys({"at", "pose"});
  const config::Node& at = node.required("at");
  const Waypoint point{at.as_duration(), pose_within(node.required("pose"), farthest)};
  if (point.at < point.at.zero()) at.fail(at.shown() + " is out of range; allowed: 0 s and later");
  return point;
}

MovingObstacle moving(const config::Node& node) {
  node.only_keys({"name", "radius", "size", "path", "repeat"});
  const config::Node& name = node.required("name");
  const config::Node *radius = node.optional("radius"), *size = node.optional("size");
  if ((radius != nullptr) == (size != nullptr))
    node.fail("a moving obstacle has either a 'radius' or a 'size', " +
              std::string(radius ? "not both" : "neither is given"));
  const config::Node* repeat = node.optional("repeat");
  MovingObstacle obstacle{name.as_text(),
                          radius ? disc_outline(positive(*radius, "m", farthest)) : rectangle_outline(extents(*size)),
                          {},
                          repeat != nullptr && repeat->as_bool()};
  if (obstacle.name.empty()) name.fail("a moving obstacle needs a name");
  const config::Node& path = node.required("path");
  for (const config::Node& item : path.list()) {
    const Waypoint point = waypoint(item);
    if (!obstacle.path.empty() && point.at <= obstacle.path.back().at)
      item.required("at").fail(item.required("at").shown() + " is not later than the waypoint before it");
    obstacle.path.push_back(point);
  }
  if (obstacle.path.empty()) path.fail("a path needs at least one waypoint {at: 0 s, pose: [x m, y m, yaw deg]}");
  if (obstacle.repeat && obstacle.path.size() < 2) path.fail("a path that repeats needs at least two waypoints");
  if (obstacle.repeat && !same_place(obstacle.path.front().pose, obstacle.path.back().pose))
    path.list().back().required("pose").fail("a path that repeats must end where it began");
  return obstacle;
}

World world(const config::Node& file, const std::string& folder) {
  file.only_keys({"kervan_world", "name", "segments", "circles", "boxes", "bitmaps", "maps", "low", "moving"});
  require_version_1(file, "kervan_world");
  const std::string name = file.required("name").as_text();
  Obstacles obstacles{.segments = shapes(file, "segments", segment),
                      .circles = shapes(file, "circles", circle),
                      .boxes = shapes(file, "boxes", box)};
  if (const config::Node* list = file.optional("bitmaps"))
    for (const config::Node& item : list->list()) obstacles.bitmaps.push_back(bitmap(item, folder));
  if (const config::Node* list = file.optional("maps"))
    for (const config::Node& item : list->list()) add_map(item, folder, obstacles);
  if (const config::Node* low = file.optional("low")) obstacles.low = low_shapes(*low);
  if (const config::Node* list = file.optional("moving"))
    for (const config::Node& item : list->list()) {
      obstacles.moving.push_back(moving(item));
      const auto same = [&](const MovingObstacle& other) { return other.name == obstacles.moving.back().name; };
      if (std::find_if(obstacles.moving.begin(), obstacles.moving.end(), same) != obstacles.moving.end() - 1)
        item.required("name").fail(item.required("name").shown() + " is the name of another moving obstacle");
    }
  return World(std::move(obstacles), name);
}

}  // namespace

World load_world(const std::string& path) {
  const std::string stem = std::filesystem::path(path).stem().string();
  if (is_aria_map(path)) return World(load_aria_map(path), stem);
  const config::Node file = config::load(path);
  // Whoever has a map of ROS should not have to write a world around it.
  if (file.is_map() && file.optional("image") != nullptr && file.optional("kervan_world") == nullptr)
    return World({.bitmaps = {ros_map(file, folder_of(path))}}, stem);
  return world(file, folder_of(path));
}

World parse_world(const std::string& text, const std::string& shown_as) {
  return world(config::parse(text, shown_as), folder_of(shown_as));
}

}  // namespace kervan::sim
