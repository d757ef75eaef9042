#include "tests/composition/fake_components.hpp"

#include <stdexcept>

namespace kervan::test {
namespace {

using namespace std::chrono_literals;

struct FakeRobot {
  std::string model = "p3dx";
  geometry::Pose2 start;
  template <class Visitor>
  void describe(Visitor& v) {
    v(model, "model", {.help = "Robot model."});
    v(start, "start", {.help = "Pose in the map.", .required = true});
  }
};

struct WorldParams {
  FilePath map;
  std::int64_t seed = 1;
  Duration step = 10ms;
  std::map<std::string, FakeRobot> robots;
  template <class Visitor>
  void describe(Visitor& v) {
    v(map, "map", {.help = "World file.", .required = true});
    v(seed, "seed", {.min = 0, .max = 4294967295.0, .help = "Seed of all noise."});
    v(step, "step", {.min = 0.001, .max = 0.1, .help = "Time step."});
    v(robots, "robots", {.help = "Robots by name."});
  }
};

struct PlannerParams {
  std::vector<geometry::Vector2> nodes;
  std::vector<std::pair<std::int64_t, std::int64_t>> edges;
  template <class Visitor>
  void describe(Visitor& v) {
    v(nodes, "nodes", {.help = "Waypoints."});
    v(edges, "edges", {.help = "Adjacency."});
  }
};

enum class Law { classical, ge_cui };

struct FieldParams {
  Law law = Law::ge_cui;
  double speed = 0.5;
  Duration period = 100ms;
  bool reverse = false;
  template <class Visitor>
  void describe(Visitor& v) {
    v(law, "law", {.choices = {"classical", "ge_cui"}, .help = "Force law."});
    v(speed, "speed", {.unit = "m/s", .min = 0.0, .max = 2.0, .help = "Speed on a free course."});
    v(period, "period", {.min = 0.01, .max = 1.0, .help = "Time between two commands."});
    v(reverse, "reverse", {.help = "May drive backwards."});
  }
};

struct MissionParams {
  std::vector<geometry::Vector2> goals;
  Duration timeout = 90s;
  template <class Visitor>
  void describe(Visitor& v) {
    v(goals, "goals", {.help = "Where to."});
    v(timeout, "timeout", {.min = 0.0, .help = "After this the mission has failed."});
  }
};

struct NoParams {
  template <class Visitor>
  void describe(Visitor&) {}
};

struct BeatParams {
  Duration period = 1s;
  template <class Visitor>
  void describe(Visitor& v) {
    v(period, "period", {.min = 0.01, .max = 10.0, .help = "Time between two beats."});
  }
};

struct GoalsParams {
  std::map<std::string, NoParams> goals;
  template <class Visitor>
  void describe(Visitor& v) {
    v(goals, "goals", {.help = "Robots by name."});
  }
};

PortInfo port(std::string name, PortDirection direction, const std::string& type, PortQos qos) {
  PortInfo info;
  info.name = std::move(name);
  info.direction = direction;
  info.type = type;
  info.layout_hash = std::hash<std::string>()(type);
  info.qos = qos;
  return info;
}
PortInfo in(std::string name, const std::string& type, PortQos qos) {
  return port(std::move(name), PortDirection::input, type, qos);
}
PortInfo out(std::string name, const std::string& type, PortQos qos) {
  return port(std::move(name), PortDirection::output, type, qos);
}

const char* const odometry = "nav_msgs::msg::Odometry";
const char* const sonars = "kervan_msgs::msg::SonarArray";
const char* const twist = "geometry_msgs::msg::TwistStamped";
const char* const pose = "geometry_msgs::msg::PoseStamped";
const char* const header = "std_msgs::msg::Header";
const char* const path = "nav_msgs::msg::Path";

std::vector<PortInfo> world_ports(const ValueMap& values) {
  std::vector<PortInfo> ports = {out("/clock", "rosgraph_msgs::msg::Clock", qos::state)};
  for (const auto& [robot, info] : load_parameters<WorldParams>(values).robots) {
    ports.push_back(out(robot + "/odom", odometry, qos::sensor));
    ports.push_back(out(robot + "/sonar", sonars, qos::sensor));
    ports.push_back(in(robot + "/cmd_vel", twist, qos::command.optional()));
  }
  return ports;
}

/// What a real planner refuses in its constructor.
void check_edges(const ValueMap& values) {
  const auto params = load_parameters<PlannerParams>(values);
  for (std::size_t i = 0; i < params.edges.size(); ++i)
    for (const std::int64_t node : {params.edges[i].first, params.edges[i].second})
      if (node < 0 || node >= static_cast<std::int64_t>(params.nodes.size()))
        throw ParameterError(
            "edges[" + std::to_string(i) + "]",
            "there is no node " + std::to_string(node) + "; there are " + std::to_string(params.nodes.size()));
}

}  // namespace

std::vector<std::string> FakeComponents::types() const {
  return {"broken/module",  "control/field", "control/pursuit", "observe/log", "observe/mission",
          "planning/astar", "safety/guard",  "sim/ghost",       "sim/world",   "test/beat",
          "test/goals",     "test/listener", "test/optional"};
}

std::vector<ParameterInfo> FakeComponents::parameters(const std::string& type) {
  if (type == "sim/world") return schema_of<WorldParams>();
  if (type == "planning/astar") return schema_of<PlannerParams>();
  if (type == "control/field") return schema_of<FieldParams>();
  if (type == "observe/mission") return schema_of<MissionParams>();
  if (type == "test/beat") return schema_of<BeatParams>();
  if (type == "test/goals") return schema_of<GoalsParams>();
  if (type == "broken/module") throw std::runtime_error("undefined symbol: kervan_component");
  return schema_of<NoParams>();
}

Manifest FakeComponents::manifest(const std::string& type, const ValueMap& values) {
  Manifest manifest;
  manifest.type = type;
  manifest.parameters = parameters(type);
  if (type == "sim/world") {
    manifest.ports = world_ports(values);
  } else if (type == "planning/astar") {
    check_edges(values);
    manifest.ports = {in("odom", odometry, qos::sensor), out("waypoint", pose, qos::latched),
                      out("route", path, qos::latched)};
  } else if (type == "control/field" || type == "control/pursuit") {
    manifest.ports = {in("odom", odometry, qos::sensor.max_age(500ms)), in("goal", pose, qos::latched),
                      out("cmd_vel", twist, qos::command)};
    if (type == "control/field") manifest.ports.push_back(in("sonar", sonars, qos::sensor.max_age(500ms)));
  } else if (type == "safety/guard") {
    manifest.ports = {in("cmd_vel_raw", twist, qos::command.deadline(250ms)), out("cmd_vel", twist, qos::command)};
  } else if (type == "sim/ghost") {
    manifest.ports = {out("sonar", sonars, qos::state)};
  } else if (type == "observe/log") {
    manifest.ports = {in("/rosout", "rcl_interfaces::msg::Log", qos::event)};
  } else if (type == "test/beat") {
    manifest.ports = {out("beat", header, qos::state)};
    manifest.timers = {{5s}, {load_parameters<BeatParams>(values).period}};
  } else if (type == "test/listener") {
    manifest.ports = {in("beat", header, qos::state.lossless().lease(2s).max_age(500ms))};
  } else if (type == "test/optional") {
    manifest.ports = {in("beat", header, qos::state.optional())};
  } else if (type == "test/goals") {
    for (const auto& [robot, goal] : load_parameters<GoalsParams>(values).goals) {
      manifest.ports.push_back(in(robot + "/odom", odometry, qos::sensor));
      manifest.ports.push_back(in(robot + "/sonar", sonars, qos::sensor));
    }
  }
  return manifest;
}

}  // namespace kervan::test
