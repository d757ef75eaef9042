#include "sim/files/robot_file.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "framework/config/node.hpp"
#include "sim/files/ranges.hpp"

namespace kervan::sim {

namespace {

constexpr double largest_robot = 10.0;  // m from the origin of base_link
constexpr std::int64_t most_beams = 100'000;
constexpr std::size_t most_sonars = 1'000;

Outline outline(const config::Node& node) {
  std::vector<Vector2> corners;
  for (const config::Node& corner : node.list()) corners.push_back(point_within(corner, largest_robot));
  try {
    return Outline(std::move(corners));
  } catch (const std::invalid_argument& error) {
    node.fail(error.what());
  }
}

DriveType drive_type(const config::Node& node) {
  return node.required("type").as_choice({"differential", "synchro"}) == "synchro" ? DriveType::synchro
                                                                                   : DriveType::differential;
}

/// A synchro drive has no track.
double track(const config::Node& node) {
  return drive_type(node) == DriveType::differential ? positive(node.required("track"), "m", largest_robot) : 0.0;
}

DriveLimits drive_limits(const config::Node& node) {
  std::vector<std::string> keys{
      "type", "track", "speed", "turn_rate", "acceleration", "deceleration", "angular_acceleration"};
  if (drive_type(node) == DriveType::synchro) std::erase(keys, "track");
  node.only_keys(keys);
  return {.speed = positive(node.required("speed"), "m/s", 100.0),
          .turn_rate = positive(node.required("turn_rate"), "rad/s", 100.0),
          .acceleration = positive(node.required("acceleration"), "m/s2", 1000.0),
          .deceleration = positive(node.required("deceleration"), "m/s2", 1000.0),
          .angular_acceleration = positive(node.required("angular_acceleration"), "rad/s2", 1000.0)};
}

/// Each of `sonars` transducers must be in one array, and in one only.
std::vector<std::vector<std::uint16_t>> arrays(const config::Node& node, std::size_t sonars) {
  std::vector<std::vector<std::uint16_t>> arrays;
  std::vector<bool> used(sonars);
  for (const config::Node& array : node.list()) {
    if (array.list().empty()) array.fail("an array needs at least one transducer");
    arrays.emplace_back();
    for (const config::Node& number : array.list()) {
      const std::int64_t i = number.as_integer();
      if (i < 0 || i >= static_cast<std::int64_t>(sonars))
        number.fail(std::to_string(i) + " is out of range; allowed: 0 .. " + std::to_string(sonars - 1));
      const auto index = static_cast<std::size_t>(i);
      if (used[index]) number.fail("transducer " + std::to_string(i) + " is in an array already");
      used[index] = true;
      arrays.back().push_back(static_cast<std::uint16_t>(i));
    }
  }
  for (std::size_t i = 0; i < sonars; ++i)
    if (!used[i]) node.fail("transducer " + std::to_string(i) + " is in no array");
  return arrays;
}

SonarRing sonars(const config::Node& node) {
  node.only_keys({"min_range", "max_range", "field_of_view", "poses", "arrays"});
  SonarRing ring;
  ring.max_range = positive(node.required("max_range"), "m", 100.0);
  ring.min_range = positive(node.required("min_range"), "m", ring.max_range);
  ring.field_of_view = positive(node.required("field_of_view"), "rad", std::numbers::pi);
  const config::Node& poses = node.required("poses");
  if (poses.list().size() > most_sonars)
    poses.fail(std::to_string(poses.list().size()) + " are too many; allowed: at most " + std::to_string(most_sonars));
  for (const config::Node& pose : poses.list()) ring.poses.push_back(pose.as_pose());
  if (const config::Node* given = node.optional("arrays")) ring.arrays = arrays(*given, ring.poses.size());
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

std::vector<Pose2> segments(const config::Node* node) {
  std::vector<Pose2> segments;
  if (node == nullptr) return segments;
  for (const config::Node& segment : node->list()) {
    segments.push_back(segment.as_pose());
    if (segments.back().position().norm() > largest_robot)
      segment.fail("is farther than " + text_of(largest_robot) + " m from the origin of base_link");
  }
  return segments;
}

BumperMount bumpers(const config::Node& node) {
  node.only_keys({"length", "front", "rear"});
  BumperMount mount;
  mount.length = positive(node.required("length"), "m", largest_robot);
  mount.front = segments(node.optional("front"));
  mount.rear = segments(node.optional("rear"));
  if (mount.front.empty() && mount.rear.empty()) node.fail("there must be segments in front, rear or both");
  return mount;
}

/// What lies within the body feels nothing.
void require_outside(const RobotModel& model, const config::Node* list) {
  constexpr double allowed = 1e-3;  // m; as files are rounded
  if (list == nullptr) return;
  for (const config::Node& segment : list->list()) {
    const double depth = depth_of_bumper(model, segment.as_pose());
    if (depth > allowed)
      segment.fail("the segment lies " + std::to_string(std::lround(1e3 * depth)) +
                   " mm within the hull of body and bumpers; it must lie on the outside");
  }
}

OdometryErrors odometry(const config::Node& node) {
  node.only_keys({"drift", "wheel_error", "wheel_slip", "resolution"});
  return {.drift = not_negative(node.required("drift"), "", 0.5),
          .wheel = not_negative(node.required("wheel_error"), "", 0.5),
          .slip = not_negative(node.required("wheel_slip"), "m", 1.0),
          .resolution = not_negative(node.required("resolution"), "m", 0.1)};
}

RobotModel robot_model(const config::Node& file) {
  file.only_keys({"kervan_robot", "name", "outline", "drive", "sonars", "laser", "bumpers", "odometry"});
  require_version_1(file, "kervan_robot");
  const config::Node& drive = file.required("drive");
  RobotModel model{.name = file.required("name").as_text(),
                   .outline = outline(file.required("outline")),
                   .drive = drive_limits(drive),
                   .drive_type = drive_type(drive),
                   .track = track(drive)};
  if (const config::Node* given = file.optional("sonars")) model.sonars = sonars(*given);
  if (const config::Node* given = file.optional("laser")) model.laser = laser(*given);
  if (const config::Node* given = file.optional("bumpers")) {
    model.bumpers = bumpers(*given);
    try {
      require_outside(model, given->optional("front"));
      require_outside(model, given->optional("rear"));
    } catch (const std::invalid_argument& error) {
      given->fail(std::string("body and bumpers have no hull: ") + error.what());
    }
  }
  if (const config::Node* given = file.optional("odometry")) model.odometry = odometry(*given);
  return model;
}

}  // namespace

RobotModel load_robot_model(const std::string& path) { return robot_model(config::load(path)); }

RobotModel parse_robot_model(const std::string& text, const std::string& shown_as) {
  return robot_model(config::parse(text, shown_as));
}

}  // namespace kervan::sim
