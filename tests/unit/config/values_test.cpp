// From a file to the values of a component's parameters.
#include "framework/config/values.hpp"

#include <gtest/gtest.h>

#include "tests/unit/config/refused.hpp"

using namespace kervan;
using namespace std::chrono_literals;
using test::refused;

namespace {

enum class Law { classical, ge_cui };

struct RobotParams {
  std::string model = "p3dx";
  geometry::Pose2 start;
  template <class Visitor>
  void describe(Visitor& v) {
    v(model, "model", {.help = "Robot model.", .required = true});
    v(start, "start", {.help = "Pose in the map."});
  }
};

struct Params {
  double speed = 0.5;
  Duration period = 100ms;
  Law law = Law::ge_cui;
  bool loop = false;
  std::int64_t seed = 1;
  FilePath map;
  std::vector<double> weights;
  std::vector<std::string> names;
  std::vector<geometry::Vector2> nodes;
  std::vector<std::pair<std::int64_t, std::int64_t>> edges;
  std::map<std::string, RobotParams> robots;
  template <class Visitor>
  void describe(Visitor& v) {
    v(speed, "speed", {.unit = "m/s", .min = 0.0, .max = 2.0, .help = "Speed."});
    v(period, "period", {.min = 0.01, .max = 1.0, .help = "Period."});
    v(law, "law", {.choices = {"classical", "ge_cui"}, .help = "Law."});
    v(loop, "loop", {.help = "Start again."});
    v(seed, "seed", {.min = 0, .help = "Seed."});
    v(map, "map", {.help = "World."});
    v(weights, "weights", {.min = 0.0, .help = "Weights."});
    v(names, "names", {.help = "Names."});
    v(nodes, "nodes", {.help = "Waypoints."});
    v(edges, "edges", {.help = "Adjacency."});
    v(robots, "robots", {.help = "Robots."});
  }
};

ValueMap values(const std::string& yaml) {
  return config::to_values(config::parse(yaml, "f.yaml"), schema_of<Params>(), "test/params");
}

Params load(const std::string& yaml) { return load_parameters<Params>(values(yaml)); }

std::string trouble(const std::string& yaml) {
  return refused([&] { values(yaml); });
}

TEST(Values, FillAStructOfEveryKind) {
  const Params p = load(R"(
speed: 36 cm/s
period: 50ms
law: classical
loop: true
seed: 7
map: worlds/lab.yaml
weights: [1, 2.5]
names: [a, "b c"]
nodes: [[0 m, 1 m], [2 m, 300 cm]]
edges: [[0, 1]]
robots: {r1: {model: p3at, start: [1 m, 2 m, 90 deg]}}
)");
  EXPECT_DOUBLE_EQ(p.speed, 0.36);
  EXPECT_EQ(p.period, 50ms);
  EXPECT_EQ(p.law, Law::classical);
  EXPECT_TRUE(p.loop);
  EXPECT_EQ(p.seed, 7);
  EXPECT_EQ(p.map.path, "worlds/lab.yaml");
  EXPECT_EQ(p.weights, (std::vector<double>{1.0, 2.5}));
  EXPECT_EQ(p.names, (std::vector<std::string>{"a", "b c"}));
  ASSERT_EQ(p.nodes.size(), 2u);
  EXPECT_DOUBLE_EQ(p.nodes[1].y(), 3.0);
  EXPECT_EQ(p.edges.at(0).second, 1);
  EXPECT_EQ(p.robots.at("r1").model, "p3at");
  EXPECT_DOUBLE_EQ(p.robots.at("r1").start.yaw, std::numbers::pi / 2);
}

TEST(Values, LeaveOutWhatIsNotGiven) { EXPECT_DOUBLE_EQ(load("{}").speed, 0.5); }

TEST(Values, AreRefusedAtTheVeryPlace) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"speed: 3 m/s", "f.yaml:1:8: speed: 3 m/s is out of range; allowed: 0 .. 2 m/s"},
      {"speed: 3", "f.yaml:1:8: speed: 3 has no unit; write e.g. 3 m/s"},
      {"speed: fast", "f.yaml:1:8: speed: 'fast' is not a speed; write a number and a unit, e.g. 1 m/s"},
      {"speed: [1 m/s]", "f.yaml:1:8: speed: expected a number with a unit (m/s, cm/s, mm/s, km/h), found a list"},
      {"period: 5ms", "f.yaml:1:9: period: 0.005 s is out of range; allowed: 0.01 .. 1 s"},
      {"law: gecui", "f.yaml:1:6: law: gecui is not one of classical, ge_cui; did you mean 'ge_cui'?"},
      {"loop: yes", "f.yaml:1:7: loop: 'yes' is not a boolean; write true (only true and false are booleans)"},
      {"seed: -1", "f.yaml:1:7: seed: -1 is out of range; allowed: at least 0"},
      {"map: ''", "f.yaml:1:6: map: the name of the file is empty"},
      {"weights: [1, -2]", "f.yaml:1:14: weights[1]: -2 is out of range; allowed: at least 0"},
      {"nodes: [[0 m, 1 m], [2 m]]", "f.yaml:1:21: nodes[1]: expected a point [x m, y m], found a list of 1"},
      {"edges: [[0, 1.5]]",
       "f.yaml:1:13: edges[0][1]: 1.5 is not an integer; write a whole number without point or exponent"},
      {"sped: 1 m/s",
       "f.yaml:1:1: test/params has no parameter 'sped'; did you mean 'speed'? it has: speed, period, law, loop, seed, "
       "map, "
       "weights, names, nodes, edges, robots"},
      {"robots: {r1: {start: [0 m, 0 m, 0 deg]}}",
       "f.yaml:1:14: r1: the parameter 'model' of robots is missing: Robot model."},
      {"robots: {r1: {model: a, strat: 1}}",
       "f.yaml:1:25: robots has no parameter 'strat'; did you mean 'start'? it has: model, start"},
  };
  for (const auto& [yaml, message] : cases) EXPECT_EQ(trouble(yaml), message) << yaml;
}

TEST(Values, AreRefusedWithoutAFileToo) {
  const auto schema = schema_of<Params>();
  const auto message = [&](const ValueMap& given) -> std::string {
    try {
      validate(schema, given);
    } catch (const ParameterError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message({{"speed", 1}}), "accepted");
  EXPECT_EQ(message({{"speed", 7.0}}), "speed: 7 m/s is out of range; allowed: 0 .. 2 m/s");
  EXPECT_EQ(message({{"speed", "fast"}}), "speed: expected number, found fast");
  EXPECT_EQ(message({{"edges", ValueList{ValueList{0, 1}, ValueList{0, 1.5}}}}),
            "edges[1][1]: expected integer, found 1.5");
  EXPECT_EQ(message({{"robots", ValueMap{{"r1", ValueMap{}}}}}), "robots.r1.model: is missing: Robot model.");
}

TEST(ValueText, IsWhatAPersonWouldWrite) {
  EXPECT_EQ(to_text(Value(0.1)), "0.1");
  EXPECT_EQ(to_text(Value("p3dx")), "p3dx");
  EXPECT_EQ(to_text(Value("10")), "\"10\"");
  EXPECT_EQ(to_text(Value(ValueList{1, true, "a b"})), "[1, true, \"a b\"]");
  EXPECT_EQ(to_text(Value(ValueMap{{"a", 1}})), "{a: 1}");
}

TEST(Nearest, FindsTypingErrorsAndNothingElse) {
  const std::vector<std::string> known = {"sonar", "odometry", "cmd_vel"};
  EXPECT_EQ(nearest("sonra", known), "sonar");
  EXPECT_EQ(nearest("Odometri", known), "odometry");
  EXPECT_EQ(nearest("cmdvel", known), "cmd_vel");
  EXPECT_EQ(nearest("battery", known), std::nullopt);
}

}  // namespace
