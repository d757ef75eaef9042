#include "sim/files/robot_file.hpp"

#include <numbers>
#include <stdexcept>
#include <utility>

#include "framework/config/node.hpp"
#include "sim/files/ranges.hpp"

namespace kervan::sim {

namespace {

constexpr double largest_robot = 10.0;  // m from the origin of base_link
constexpr std::int64_t most_beams = 100'000;

Outline outline(const config::Node& node) {
  std::vector<Vector2> corners;
  for (const config::Node& corner : node.list()) corners.push_back(point_within(corner, largest_robot));
  try {
    return Outline(std::move(corners));
  } catch (const std::invalid_argument& error) {
    node.fail(error.what());
  }
}

DriveLimits drive(const config::Node& node) {
  node.only_keys({"type", "speed", "turn_rate", "acceleration", "deceleration", "angular_acceleration"});
  node.required("type").as_choice({"differential"});
  return {.speed = positive(node.required("speed"), "m/s", 100.0),
          .turn_rate = positive(node.required("turn_rate"), "rad/s", 100.0),
          .acceleration = positive(node.required("acceleration"), "m/s2", 1000.0),
          .deceleration = positive(node.required("deceleration"), "m/s2", 1000.0),
          .angular_acceleration = positive(node.required("angular_acceleration"), "rad/s2", 1000.0)};
}

SonarRing sonars(const config::Node& node) {
  node.only_keys({"min_range", "max_range", "field_of_view", "poses"});
  SonarRing ring;
  ring.max_range = positive(node.required("max_range"), "m", 100.0);
  ring.min_range = positive(node.required("min_range"), "m", ring.max_range);
  ring.field_of_view = positive(node.required("field_of_view"), "rad", std::numbers::pi);
  for (const config::Node& pose : node.required("poses").list()) ring.poses.push_back(pose.as_pose());
  return ring;
}

LaserMount laser(const config::Node& node) {
  node.only_keys({"pose", "beams", "field_of_view", "min_range", "max_range"});
  LaserMount mount;
  mount.pose = node.required("pose").as_pose();
  const config::Node& beams = node.required("beams");
  const std::int64_t count = beams.as_integer();
  if (count < 2 || count > most_beams)
    beams.fail(std::to_string(count) + " is out of range; allowed: 2 .. " + std::to_string(most_beams));
  mount.beams = static_cast<int>(count);
  const config::Node& field = node.required("field_of_view");
  mount.field_of_view = positive(field, "rad", 2.0 * std::numbers::pi);
  if (!(mount.field_of_view < 2.0 * std::numbers::pi))
    field.fail("the first and the last beam would be the same; a full turn of n beams has (n - 1) / n of it");
  mount.max_range = positive(node.required("max_range"), "m", 1000.0);
  mount.min_range = positive(node.required("min_range"), "m", mount.max_range);
  return mount;
}

RobotModel robot_model(const config::Node& file) {
  file.only_keys({"kervan_robot", "name", "outline", "drive", "sonars", "laser"});
  require_version_1(file, "kervan_robot");
  return {.name = file.required("name").as_text(),
          .outline = outline(file.required("outline")),
          .drive = drive(file.required("drive")),
          .sonars = file.optional("sonars") ? sonars(file.required("sonars")) : SonarRing{},
          .laser = file.optional("laser") ? std::optional(laser(file.required("laser"))) : std::nullopt};
}

}  // namespace

RobotModel load_robot_model(const std::string& path) { return robot_model(config::load(path)); }

RobotModel parse_robot_model(const std::string& text, const std::string& shown_as) {
  return robot_model(config::parse(text, shown_as));
}

}  // namespace kervan::sim
