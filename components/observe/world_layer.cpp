#include "components/observe/world_layer.hpp"

#include <cstdint>

#include "components/observe/decimal.hpp"

namespace kervan::observe {

using geometry::Vector2;

namespace {

std::string points_of(const Polyline& corners) {
  std::string points;
  for (const auto& corner : corners)
    if (corner.allFinite()) points += metres(corner.x()) + ',' + metres(-corner.y()) + ' ';
  return points;
}

/// As RFC 4648 has it: six bits a letter.
std::string base64(const std::string& bytes) {
  static constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return i + k < bytes.size() ? std::uint32_t{static_cast<unsigned char>(bytes[i + k])} : 0u;
    };
    const std::uint32_t three = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : letters[three >> (18 - 6 * k) & 63];
  }
  return text;
}

}  // namespace

std::string metres(double value) { return decimal(value, 4); }
std::string pixels(double value) { return decimal(value, 1); }

void WorldLayer::line(const Polyline& points, const char* colour, double width, const std::string& dashes,
                      const char* opacity) {
  std::string data;
  for (const auto& point : points) {
    if (!point.allFinite()) continue;
    data += data.empty() ? "M" : " L";
    data += metres(point.x()) + ',' + metres(-point.y());
  }
  if (data.empty()) return;
  svg_.element("path", {{"d", data},
                        {"fill", "none"},
                        {"stroke", colour},
                        {"stroke-width", metres(width * px_)},
                        {"stroke-dasharray", dashes},
                        {"stroke-opacity", opacity},
                        {"stroke-linecap", "round"},
                        {"stroke-linejoin", "round"}});
}

void WorldLayer::circle(const Vector2& center, double radius, const char* fill, const char* stroke, double width,
                        const std::string& dashes) {
  if (!center.allFinite()) return;
  svg_.element("circle", {{"cx", metres(center.x())},
                          {"cy", metres(-center.y())},
                          {"r", metres(radius)},
                          {"fill", fill},
                          {"stroke", stroke},
                          {"stroke-width", metres(width * px_)},
                          {"stroke-dasharray", dashes}});
}

void WorldLayer::polygon(const Polyline& corners, const char* fill, const char* stroke, double width) {
  const std::string points = points_of(corners);
  if (points.empty()) return;
  svg_.element("polygon", {{"points", points},
                           {"fill", fill},
                           {"stroke", stroke},
                           {"stroke-width", metres(width * px_)},
                           {"stroke-linejoin", "round"}});
}

void WorldLayer::veil(const Polyline& corners, const char* colour) {
  const std::string points = points_of(corners);
  if (points.empty()) return;
  svg_.element("polygon", {{"points", points},
                           {"fill", colour},
                           {"fill-opacity", "0.1"},
                           {"stroke", colour},
                           {"stroke-opacity", "0.5"},
                           {"stroke-width", metres(0.6 * px_)},
                           {"stroke-linejoin", "round"}});
}

void WorldLayer::image(const Vector2& low, double width, double height, const std::string& png) {
  svg_.element("image", {{"x", metres(low.x())},
                         {"y", metres(-low.y() - height)},
                         {"width", metres(width)},
                         {"height", metres(height)},
                         {"preserveAspectRatio", "none"},
                         {"image-rendering", "pixelated"},
                         {"href", "data:image/png;base64," + base64(png)}});
}

// Fonts smaller than one unit are drawn badly by some programs, so the text has a coordinate system of its own in
// pixels.
void WorldLayer::label(const Vector2& at, const std::string& content, double size, const char* colour,
                       const char* anchor, const Vector2& offset, const char* weight, bool halo) {
  if (!at.allFinite()) return;
  svg_.text(content,
            {{"transform", "translate(" + metres(at.x()) + ' ' + metres(-at.y()) + ") scale(" + decimal(px_, 6) + ")"},
             {"x", pixels(offset.x())},
             {"y", pixels(offset.y())},
             {"font-size", pixels(size)},
             {"font-weight", weight},
             {"fill", colour},
             {"stroke", halo ? "#ffffff" : ""},
             {"stroke-width", halo ? "3" : ""},
             {"stroke-linejoin", halo ? "round" : ""},
             {"paint-order", halo ? "stroke" : ""},
             {"text-anchor", anchor}});
}

}  // namespace kervan::observe
