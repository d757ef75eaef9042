#include "tests/scenario/scenario.hpp"

#include <algorithm>

#include "framework/config/node.hpp"

namespace kervan::test {
namespace fs = std::filesystem;
using config::Node;
namespace {

const std::vector<std::string> figures = {"error_m", "time_s", "path_m", "contacts", "min_clearance_m"};

Bounds bounds(const Node& node) {
  const auto& ends = node.list_of(2, "[least, most]");
  const Bounds bounds{ends[0].as_number(), ends[1].as_number()};
  if (bounds.least > bounds.most) node.fail("the least is above the most");
  return bounds;
}

RobotExpectation robot(const Node& node) {
  std::vector<std::string> allowed = figures;
  allowed.insert(allowed.end(), {"reached", "closest_m"});
  node.only_keys(allowed);
  RobotExpectation expected;
  if (const Node* reached = node.optional("reached")) expected.reached = reached->as_bool();
  for (const std::string& figure : figures)
    if (const Node* given = node.optional(figure)) expected.figures[figure] = bounds(*given);
  if (const Node* closest = node.optional("closest_m")) {
    closest->only_keys({"to", "range"});
    expected.closest = {closest->required("to").as_point(), bounds(closest->required("range"))};
  }
  return expected;
}

}  // namespace

Scenario load_scenario(const fs::path& file) {
  const Node root = config::load(file.string());
  root.only_keys({"kervan_scenario", "help", "composition", "place", "for", "args", "seeds", "expect"});
  const Node& version = root.required("kervan_scenario");
  if (version.as_integer() != 1) version.fail("this is version 1 of the format");

  Scenario scenario;
  scenario.name = file.stem().string();
  scenario.help = root.required("help").as_text();
  scenario.composition = root.required("composition").as_text();
  if (scenario.composition.find('/') != std::string::npos)
    scenario.composition = (file.parent_path().parent_path() / scenario.composition).string();
  if (const Node* place = root.optional("place")) {
    place->as_choice({"all"});
    scenario.place_all = true;
  }
  if (const Node* length = root.optional("for")) scenario.length = length->as_text();
  if (const Node* arguments = root.optional("args"))
    for (const Node& argument : arguments->map())
      scenario.arguments.push_back(argument.name + "=" + argument.as_text());
  if (const Node* seeds = root.optional("seeds")) {
    const auto& ends = seeds->list_of(2, "[from, to]");
    scenario.first_seed = ends[0].as_integer();
    scenario.last_seed = ends[1].as_integer();
    if (*scenario.first_seed > *scenario.last_seed) seeds->fail("the first is above the last");
  }
  const Node& expect = root.required("expect");
  expect.only_keys({"result", "exit_code", "robots", "figures", "warnings"});
  scenario.result = expect.required("result").as_choice({"success", "failed", "aborted"});
  scenario.exit_code = static_cast<int>(expect.required("exit_code").as_integer());
  if (const Node* robots = expect.optional("robots"))
    for (const Node& expected : robots->map()) scenario.robots[expected.name] = robot(expected);
  if (const Node* components = expect.optional("figures"))
    for (const Node& component : components->map())
      for (const Node& figure : component.map()) scenario.figures[component.name][figure.name] = bounds(figure);
  if (const Node* warnings = expect.optional("warnings"))
    for (const Node& warning : warnings->list()) scenario.warnings.push_back(warning.as_text());
  return scenario;
}

std::vector<fs::path> scenario_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace kervan::test
