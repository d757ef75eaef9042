// Every file in scenarios/, with each of its seeds, run by the real program.
#include "tests/scenario/scenario.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Case {
  std::string file;
  std::optional<std::int64_t> seed;
  bool first = false;  ///< of its scenario
};

std::ostream& operator<<(std::ostream& out, const Case& test) { return out << test.file; }

/// A scenario that cannot be read is one test, which says why.
std::vector<Case> cases() {
  std::vector<Case> cases;
  for (const fs::path& file : scenario_files(SCENARIO_TESTS "/scenarios")) {
    Scenario scenario;
    try {
      scenario = load_scenario(file);
    } catch (const std::exception&) {
    }
    if (!scenario.first_seed) {
      cases.push_back({file.string(), std::nullopt, true});
      continue;
    }
    for (std::int64_t seed = *scenario.first_seed; seed <= *scenario.last_seed; ++seed)
      cases.push_back({file.string(), seed, seed == *scenario.first_seed});
  }
  return cases;
}

std::string name_of(const testing::TestParamInfo<Case>& test) {
  return fs::path(test.param.file).stem().string() +
         (test.param.seed ? "_seed_" + std::to_string(*test.param.seed) : "");
}

/// What one run printed and left behind.
struct ScenarioRun {
  Result result;
  json summary;                         ///< the line that --json printed
  json written;                         ///< summary.json
  std::vector<std::string> trajectory;  ///< rows of trajectory.csv, the header first
};

ScenarioRun run_scenario(const Scenario& scenario, std::optional<std::int64_t> seed, unsigned threads) {
  Command command{KERVAN_PROGRAM, {"run", scenario.composition, "--json", "--threads", std::to_string(threads)}};
  if (scenario.place_all) command.arguments.insert(command.arguments.end(), {"--place", "all"});
  if (!scenario.length.empty()) command.arguments.insert(command.arguments.end(), {"--for", scenario.length});
  std::vector<std::string> arguments = scenario.arguments;
  if (seed) arguments.push_back("seed=" + std::to_string(*seed));
  for (const std::string& argument : arguments) command.arguments.insert(command.arguments.end(), {"--arg", argument});
  command.environment["KERVAN_COMPONENT_PATH"] = SCENARIO_COMPONENTS;
  const Folder folder;
  ScenarioRun run;
  run.result = test::run(command, folder.path());
  const auto lines = lines_of(run.result.out);
  if (lines.size() != 1)
    throw std::runtime_error("standard output is not one line of JSON:\n" + run.result.out + run.result.err);
  run.summary = json::parse(lines.back());
  for (const auto& entry : fs::directory_iterator(folder.path() / "runs")) {
    run.written = json::parse(text_of(entry.path() / "summary.json"));
    run.trajectory = lines_of(text_of(entry.path() / "trajectory.csv"));
  }
  return run;
}

double closest_approach(const std::vector<std::string>& trajectory, const std::string& robot,
                        const geometry::Vector2& point) {
  double closest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    std::vector<std::string> cells;
    std::istringstream row(trajectory[i]);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (cells.size() < 4 || cells[1] != robot) continue;
    closest = std::min(closest, std::hypot(std::stod(cells[2]) - point.x(), std::stod(cells[3]) - point.y()));
  }
  return closest;
}

void expect_within(double value, const Bounds& bounds, const std::string& what) {
  EXPECT_GE(value, bounds.least) << what;
  EXPECT_LE(value, bounds.most) << what;
}

void check_robot(const ScenarioRun& run, const std::string& name, const RobotExpectation& expected) {
  ASSERT_TRUE(run.summary["robots"].contains(name)) << run.summary;
  const json& robot = run.summary["robots"][name];
  if (expected.reached) {
    EXPECT_EQ(robot["reached"].get<bool>(), *expected.reached) << name;
  }
  for (const auto& [figure, bounds] : expected.figures) {
    ASSERT_TRUE(robot[figure].is_number()) << name << "." << figure << " is " << robot[figure];
    expect_within(robot[figure].get<double>(), bounds, name + "." + figure);
  }
  if (expected.closest)
    expect_within(closest_approach(run.trajectory, name, expected.closest->to), expected.closest->range,
                  name + ": closest approach in trajectory.csv");
}

std::vector<std::string> unexpected_warnings(const std::string& console, const Scenario& scenario) {
  std::vector<std::string> unexpected;
  for (const std::string& line : lines_of(console)) {
    const auto in_line = [&line](const std::string& text) { return line.find(text) != std::string::npos; };
    if (in_line("warning [") && std::none_of(scenario.warnings.begin(), scenario.warnings.end(), in_line))
      unexpected.push_back(line);
  }
  return unexpected;
}

class ScenarioTest : public testing::TestWithParam<Case> {};

TEST_P(ScenarioTest, EndsAsExpected) {
  const Scenario scenario = load_scenario(GetParam().file);
  SCOPED_TRACE(scenario.help);
  const ScenarioRun run = run_scenario(scenario, GetParam().seed, 1);
  EXPECT_EQ(run.summary["result"], scenario.result) << run.result.err;
  EXPECT_EQ(run.result.code, scenario.exit_code) << run.result.err;
  EXPECT_EQ(run.summary, run.written) << "summary.json must say the same as --json";
  for (const std::string& warning : unexpected_warnings(run.result.err, scenario)) ADD_FAILURE() << warning;
  EXPECT_EQ(run.result.err.find("error ["), std::string::npos) << run.result.err;
  for (const auto& [name, expected] : scenario.robots) check_robot(run, name, expected);
  for (const auto& [component, figures] : scenario.figures)
    for (const auto& [figure, bounds] : figures) {
      const json value = run.summary.value(json::json_pointer("/figures/" + component + "/" + figure), json());
      ASSERT_TRUE(value.is_number()) << component << "." << figure << " is " << value << " in " << run.summary;
      expect_within(value.get<double>(), bounds, component + "." + figure);
    }

  const double speed = run.summary["simulated_s"].get<double>() / run.summary["wall_s"].get<double>();
  std::cout << scenario.name << ": " << static_cast<int>(speed) << "x real time\n";
  if (!GetParam().first) return;
  const std::string trace = run.summary["trace_hash"];
  EXPECT_EQ(run_scenario(scenario, GetParam().seed, 1).summary["trace_hash"], trace) << "the same again";
  EXPECT_EQ(run_scenario(scenario, GetParam().seed, 4).summary["trace_hash"], trace) << "with four threads";
  if (!scenario.place_all) return;
  Scenario split = scenario;
  split.place_all = false;
  EXPECT_EQ(run_scenario(split, GetParam().seed, 1).summary["trace_hash"], trace) << "in its own containers";
}

INSTANTIATE_TEST_SUITE_P(Scenario, ScenarioTest, testing::ValuesIn(cases()), name_of);

TEST(Traces, DifferFromSeedToSeed) {
  Scenario lab;
  lab.composition = "lab";
  EXPECT_NE(run_scenario(lab, 1, 1).summary["trace_hash"], run_scenario(lab, 2, 1).summary["trace_hash"]);
}

}  // namespace
}  // namespace kervan::test
