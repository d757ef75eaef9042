#include "sim/files/aria_map.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "framework/component/error.hpp"
#include "framework/map_file/image.hpp"
#include "sim/files/ranges.hpp"

namespace kervan::sim {

namespace {

constexpr double millimetre = 1e-3;  // this format's only unit

/// A number that the header announces, and where it stands.
struct Announced {
  double value;
  int line;
};

class AriaReader {
 public:
  AriaReader(const std::string& text, std::string name) : stream_(text), name_(std::move(name)) {}

  Obstacles read() {
    if (!next() || text_ != "2D-Map") fail("not a map of ARIA: the first line must be 2D-Map");
    enum { header, lines, points } part = header;
    while (next()) {
      if (text_.empty()) continue;
      if (text_ == "LINES") {
        part = lines;
      } else if (text_ == "DATA") {
        part = points;
      } else if (part == header) {
        read_header();
      } else if (part == lines) {
        const auto [a, b, c, d] = numbers<4>("the ends of a line: x1 y1 x2 y2, in mm");
        if (a == c && b == d) fail("both ends of the line are the same point");
        obstacles_.segments.push_back({{a * millimetre, b * millimetre}, {c * millimetre, d * millimetre}});
      } else {
        points_.push_back(numbers<2>("a point: x y, in mm"));
      }
    }
    require_count(line_count_, obstacles_.segments.size(), "NumLines", "lines");
    require_count(point_count_, points_.size(), "NumPoints", "points");
    if (!points_.empty()) obstacles_.bitmaps.push_back(bitmap_of_points());
    return std::move(obstacles_);
  }

 private:
  [[noreturn]] void fail_at(int line, const std::string& message) const {
    throw ConfigError({name_, line, 1}, message);
  }
  [[noreturn]] void fail(const std::string& message) const { fail_at(line_, message); }

  bool next() {
    ++line_;
    if (!std::getline(stream_, text_)) return false;
    while (!text_.empty() && (text_.back() == '\r' || text_.back() == ' ')) text_.pop_back();
    return true;
  }

  /// The numbers of a line, each within the reach of a map.
  template <std::size_t count>
  std::array<double, count> numbers(const char* what) const {
    return numbers_in<count>(text_, what);
  }

  template <std::size_t count>
  std::array<double, count> numbers_in(const std::string& text, const char* what) const {
    std::istringstream words(text);
    std::array<double, count> values{};
    for (double& value : values)
      if (!(words >> value)) fail("'" + text + "' is not " + what);
    if (!(words >> std::ws).eof()) fail("'" + text + "' is not " + what);
    for (const double value : values)
      if (!(std::abs(value * millimetre) <= farthest)) fail("'" + text + "' is out of range; allowed: 1000 km");
    return values;
  }

  void read_header() {
    const auto colon = text_.find(':');
    if (colon == std::string::npos) fail("'" + text_ + "' is no line of a map's header; expected KEY: VALUE");
    const std::string key = text_.substr(0, colon), value = text_.substr(colon + 1);
    const auto number = [&] { return Announced{numbers_in<1>(value, "a number")[0], line_}; };
    if (key == "NumLines") line_count_ = number();
    if (key == "NumPoints") point_count_ = number();
    if (key == "Resolution") resolution_ = number();
    if (resolution_ && resolution_->line == line_ && !(resolution_->value > 0.0))
      fail("the resolution must be above 0 mm");
  }

  void require_count(const std::optional<Announced>& announced, std::size_t found, const char* key,
                     const char* what) const {
    if (announced && announced->value != static_cast<double>(found))
      fail_at(announced->line, std::string(key) + ": " + text_of(announced->value) + " " + what +
                                   " are announced, the file has " + std::to_string(found));
  }

  Bitmap bitmap_of_points() const {
    if (!resolution_) fail_at(1, "a map with points needs a Resolution");
    const double step = resolution_->value;
    double low_x = infinity, low_y = infinity, high_x = -infinity, high_y = -infinity;
    for (const auto& [x, y] : points_) {
      low_x = std::min(low_x, x);
      low_y = std::min(low_y, y);
      high_x = std::max(high_x, x);
      high_y = std::max(high_y, y);
    }
    const double columns = std::round((high_x - low_x) / step) + 1.0, rows = std::round((high_y - low_y) / step) + 1.0;
    if (columns * rows > static_cast<double>(most_cells))
      fail_at(resolution_->line, "the points lie too far from each other for this resolution: " + text_of(columns) +
                                     " x " + text_of(rows) + " cells; allowed: " + std::to_string(most_cells));
    Bitmap map;
    map.origin = {(low_x - 0.5 * step) * millimetre, (low_y - 0.5 * step) * millimetre, 0.0};
    map.cell = Vector2::Constant(step * millimetre);
    map.columns = static_cast<int>(columns);
    map.rows = static_cast<int>(rows);
    map.solid.resize(static_cast<std::size_t>(columns * rows));
    for (const auto& [x, y] : points_)
      map.solid[static_cast<std::size_t>(std::round((y - low_y) / step) * columns + std::round((x - low_x) / step))] =
          1;
    return map;
  }

  std::istringstream stream_;
  std::string name_;
  std::string text_;  // the present line
  int line_ = 0;
  std::optional<Announced> line_count_, point_count_, resolution_;
  std::vector<std::array<double, 2>> points_;  // mm
  Obstacles obstacles_;
};

}  // namespace

Obstacles load_aria_map(const std::string& path) {
  try {
    return parse_aria_map(map_file::read_file(path), path);
  } catch (const std::invalid_argument& error) {
    throw ConfigError({path, 0, 0}, error.what());
  }
}

Obstacles parse_aria_map(const std::string& text, const std::string& shown_as) {
  return AriaReader(text, shown_as).read();
}

}  // namespace kervan::sim
