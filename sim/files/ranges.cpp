#include "sim/files/ranges.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <string>

namespace kervan::sim {

std::string text_of(double number) {
  std::array<char, 32> buffer{};
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, std::chars_format::general, 8);
  return {buffer.data(), end};
}

double positive(const config::Node& node, std::string_view unit, double highest) {
  const double value = node.as_quantity(unit);
  if (!(value > 0.0 && value <= highest))
    node.fail(node.shown() + " is out of range; allowed: above 0, at most " + text_of(highest) + " " +
              std::string(unit));
  return value;
}

double not_negative(const config::Node& node, std::string_view unit, double highest) {
  const double value = node.as_quantity(unit);
  if (!(value >= 0.0 && value <= highest))
    node.fail(node.shown() + " is out of range; allowed: 0 .. " + text_of(highest) + (unit.empty() ? "" : " ") +
              std::string(unit));
  return value;
}

namespace {

void require_within(const config::Node& coordinate, double value, double limit) {
  if (std::abs(value) > limit)
    coordinate.fail(coordinate.shown() + " is out of range; allowed: -" + text_of(limit) + " .. " + text_of(limit) +
                    " m");
}

}  // namespace

Vector2 point_within(const config::Node& node, double limit) {
  const Vector2 point = node.as_point();
  for (int i = 0; i < 2; ++i) require_within(node.children[static_cast<std::size_t>(i)], point[i], limit);
  return point;
}

Pose2 pose_within(const config::Node& node, double limit) {
  const Pose2 pose = node.as_pose();
  require_within(node.children[0], pose.x, limit);
  require_within(node.children[1], pose.y, limit);
  return pose;
}

void require_version_1(const config::Node& file, std::string_view key) {
  const config::Node& version = file.required(key);
  if (version.as_integer() != 1) version.fail(version.shown() + " is not a known version of this format; allowed: 1");
}

}  // namespace kervan::sim
