#include "sim/files/ros_map.hpp"

#include <cmath>
#include <filesystem>
#include <numbers>

#include "sim/files/image.hpp"
#include "sim/files/ranges.hpp"

namespace kervan::sim {

namespace {

double share(const config::Node* node, double otherwise) {
  if (node == nullptr) return otherwise;
  const double value = node->as_number();
  if (!(value >= 0.0 && value <= 1.0)) node->fail(node->shown() + " is out of range; allowed: 0 .. 1");
  return value;
}

double number_within(const config::Node& node, double limit, const char* unit) {
  const double value = node.as_number();
  if (std::abs(value) > limit)
    node.fail(node.shown() + " is out of range; allowed: -" + text_of(limit) + " .. " + text_of(limit) + unit);
  return value;
}

bool negated(const config::Node* node) {
  if (node == nullptr) return false;
  const std::string choice = node->as_choice({"0", "1", "false", "true"});
  return choice == "1" || choice == "true";
}

}  // namespace

Bitmap ros_map(const config::Node& file, const std::string& folder) {
  file.only_keys({"image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode"});
  const config::Node& picture = file.required("image");
  const config::Node& resolution = file.required("resolution");
  Bitmap map;
  map.cell = Vector2::Constant(resolution.as_number());
  if (!(map.cell.x() > 0.0 && map.cell.x() <= 1000.0))
    resolution.fail(resolution.shown() + " is out of range; allowed: above 0, at most 1000 (metres per pixel)");
  const auto& origin = file.required("origin").list_of(3, "the pose of the lower left corner [x, y, yaw]");
  map.origin = {number_within(origin[0], farthest, " (metres)"), number_within(origin[1], farthest, " (metres)"),
                number_within(origin[2], 2.0 * std::numbers::pi, " (radians)")};
  const bool negate = negated(file.optional("negate"));
  const double occupied = share(file.optional("occupied_thresh"), 0.65);
  const double free = share(file.optional("free_thresh"), 0.196);
  if (free > occupied)
    file.required("free_thresh").fail("the free threshold is above occupied_thresh (" + text_of(occupied) + ")");
  const config::Node* mode = file.optional("mode");
  const bool raw = mode != nullptr && mode->as_choice({"trinary", "scale", "raw"}) == "raw";

  Image image;
  const std::string path = (std::filesystem::path(folder) / picture.as_text()).string();
  try {
    image = load_image(path);
  } catch (const std::invalid_argument& error) {
    picture.fail(path + ": " + error.what());
  }
  map.columns = image.columns;
  map.rows = image.rows;
  map.solid = solid_pixels(image, [=](Pixel pixel) {
    // In raw mode a shade is a probability in percent, and above 100 unknown; trinary and scale differ only between the
    // two thresholds, where nothing is solid.
    if (raw) return pixel.shade <= 100 && pixel.shade > 100.0 * occupied;
    return pixel.opacity == 255 && (negate ? pixel.shade : 255 - pixel.shade) > 255.0 * occupied;
  });
  return map;
}

Bitmap load_ros_map(const std::string& path) {
  return ros_map(config::load(path), std::filesystem::path(path).parent_path().string());
}

}  // namespace kervan::sim
