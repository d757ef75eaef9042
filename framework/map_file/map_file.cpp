#include "framework/map_file/map_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <stdexcept>

#include "framework/map_file/image.hpp"

namespace kervan::map_file {
namespace {

// What map_saver writes, and what map_server takes for it.
constexpr std::uint8_t black = 0, grey = 205, white = 254;
constexpr double usual_occupied = 0.65, usual_free = 0.196;

/// The shortest text that is read back as the same number, or with `digits` the rounded one.
std::string text_of(double number, int digits = 0) {
  std::array<char, 32> buffer{};
  const auto end =
      digits == 0
          ? std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr
          : std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, std::chars_format::general, digits).ptr;
  return {buffer.data(), end};
}

double share(const config::Node* node, double otherwise) {
  if (node == nullptr) return otherwise;
  const double value = node->as_number();
  if (!(value >= 0.0 && value <= 1.0)) node->fail(node->shown() + " is out of range; allowed: 0 .. 1");
  return value;
}

double number_within(const config::Node& node, double limit, const char* unit) {
  const double value = node.as_number();
  if (std::abs(value) > limit)
    node.fail(node.shown() + " is out of range; allowed: -" + text_of(limit, 8) + " .. " + text_of(limit, 8) + unit);
  return value;
}

bool negated(const config::Node* node) {
  if (node == nullptr) return false;
  const std::string choice = node->as_choice({"0", "1", "false", "true"});
  return choice == "1" || choice == "true";
}

Mode mode_of(const config::Node* node) {
  if (node == nullptr) return Mode::trinary;
  const std::string choice = node->as_choice({"trinary", "scale", "raw"});
  return choice == "raw" ? Mode::raw : choice == "scale" ? Mode::scale : Mode::trinary;
}

/// How shades become probabilities.
struct Reading {
  Mode mode;
  bool negate;
  double occupied, free;  // thresholds, 0 .. 1

  std::int8_t operator()(Pixel pixel) const {
    if (mode == Mode::raw) return pixel.shade <= 100 ? static_cast<std::int8_t>(pixel.shade) : std::int8_t{-1};
    if (pixel.opacity != 255) return -1;
    const double darkness = negate ? pixel.shade : 255 - pixel.shade;
    if (darkness > 255.0 * occupied) return 100;
    if (darkness < 255.0 * free) return 0;
    if (mode == Mode::trinary || !(occupied > free)) return -1;
    return static_cast<std::int8_t>(std::lround(1.0 + 98.0 * (darkness / 255.0 - free) / (occupied - free)));
  }
};

Pixel shade_of(std::int8_t occupancy, Mode mode) {
  if (mode == Mode::raw) return {occupancy < 0 ? std::uint8_t{255} : static_cast<std::uint8_t>(occupancy)};
  const double share = 0.01 * occupancy;
  return {occupancy < 0 ? grey : share > usual_occupied ? black : share < usual_free ? white : grey};
}

Image picture_of(const GridMap& map, Mode mode) {
  Image image{map.columns, map.rows, {}};
  const auto columns = static_cast<std::size_t>(map.columns);
  image.pixels.reserve(map.occupancy.size());
  for (std::size_t row = static_cast<std::size_t>(map.rows); row-- > 0;)
    for (std::size_t column = 0; column < columns; ++column)
      image.pixels.push_back(shade_of(map.occupancy[row * columns + column], mode));
  return image;
}

/// A descriptor that is closed again.
struct Descriptor {
  int number;
  explicit Descriptor(int opened) : number(opened) {}
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

[[noreturn]] void fail_to_write(const std::string& path) {
  throw std::invalid_argument(path + ": cannot be written: " + std::strerror(errno));
}

}  // namespace

GridMap parse(const config::Node& file, const std::string& folder) {
  file.only_keys({"image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode"});
  const config::Node& picture = file.required("image");
  const config::Node& resolution = file.required("resolution");
  GridMap map;
  map.resolution = resolution.as_number();
  if (!(map.resolution > 0.0 && map.resolution <= 1000.0))
    resolution.fail(resolution.shown() + " is out of range; allowed: above 0, at most 1000 (metres per pixel)");
  const auto& origin = file.required("origin").list_of(3, "the pose of the lower left corner [x, y, yaw]");
  map.origin = {number_within(origin[0], farthest_corner, " (metres)"),
                number_within(origin[1], farthest_corner, " (metres)"),
                number_within(origin[2], 2.0 * std::numbers::pi, " (radians)")};
  const bool negate = negated(file.optional("negate"));
  const double occupied = share(file.optional("occupied_thresh"), usual_occupied);
  const double free = share(file.optional("free_thresh"), usual_free);
  if (free > occupied)
    file.required("free_thresh").fail("the free threshold is above occupied_thresh (" + text_of(occupied, 8) + ")");
  const Mode mode = mode_of(file.optional("mode"));

  Image image;
  const std::string path = (std::filesystem::path(folder) / picture.as_text()).string();
  try {
    image = load_image(path);
  } catch (const std::invalid_argument& error) {
    picture.fail(path + ": " + error.what());
  }
  map.columns = image.columns;
  map.rows = image.rows;
  map.occupancy = cells_of(image, Reading{mode, negate, occupied, free});
  // Below the threshold of occupancy the other modes give at most 99.
  map.occupied_above = mode == Mode::raw ? 100.0 * occupied : 99.5;
  return map;
}

GridMap load(const std::string& path) {
  return parse(config::load(path), std::filesystem::path(path).parent_path().string());
}

void save(const GridMap& map, const std::string& path, Mode mode, Format format) {
  const bool png = format == Format::png;
  const std::filesystem::path picture = std::filesystem::path(path).replace_extension(png ? ".png" : ".pgm");
  std::string bytes;
  try {
    const Image image = picture_of(map, mode);
    bytes = png ? to_png(image) : to_pgm(image);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(path + ": " + error.what());
  }
  replace_file(picture.string(), bytes);
  replace_file(path, "image: " + picture.filename().string() + "\nresolution: " + text_of(map.resolution) +
                         "\norigin: [" + text_of(map.origin.x) + ", " + text_of(map.origin.y) + ", " +
                         text_of(map.origin.yaw) + "]\nnegate: 0\noccupied_thresh: " + text_of(usual_occupied) +
                         "\nfree_thresh: " + text_of(usual_free) +
                         (mode == Mode::raw ? "\nmode: raw\n" : "\nmode: trinary\n"));
}

void replace_file(const std::string& path, const std::string& bytes) {
  const std::string fresh = path + ".new";
  {
    const Descriptor file(::open(fresh.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
    if (file.number < 0) fail_to_write(path);
    for (std::size_t written = 0; written < bytes.size();) {
      const ::ssize_t count = ::write(file.number, bytes.data() + written, bytes.size() - written);
      if (count < 0 && errno != EINTR) fail_to_write(path);
      if (count > 0) written += static_cast<std::size_t>(count);
    }
    if (::fsync(file.number) != 0) fail_to_write(path);
  }
  if (::rename(fresh.c_str(), path.c_str()) != 0) fail_to_write(path);
  // The new name is durable once its folder is.
  const std::string parent = std::filesystem::path(path).parent_path().string();
  const Descriptor folder(::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.number < 0 || ::fsync(folder.number) != 0) fail_to_write(path);
}

}  // namespace kervan::map_file
