// The shipped compositions in one, two and five containers: equal seeds leave equal traces, wherever the components
// run.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Shipped {
  const char* name;
  const char* in_two;
  const char* in_five;
};

const Shipped shipped[] = {
    {"lab", "{sim: {components: [world, report, mission]}, robot: {components: [r1]}}",
     "{sim: {components: [world]}, watch: {components: [report, mission]}, plan: {components: [r1/planner, "
     "r1/follower]},"
     " control: {components: [r1/control]}, guard: {components: [r1/guard]}}"},
    {"02_two_robots", "{sim: {components: [world, report, mission]}, robots: {components: [r1, r2]}}",
     "{sim: {components: [world]}, watch: {components: [report, mission]}, one: {components: [r1]}, plan: {components: "
     "[r2/planner, r2/follower]}, drive: {components: [r2/control, r2/guard]}}"},
    {"03_ten_robots",
     "{sim: {components: [world, report, mission]}, robots: {components: [r01, r02, r03, r04, r05, r06, r07, r08, r09, "
     "r10]}}",
     "{sim: {components: [world, report, mission]}, a: {components: [r01, r02, r03]}, b: {components: [r04, r05]}, c: "
     "{components: [r06, r07, r08]}, d: {components: [r09, r10]}}"}};

/// Whole runs of ten seeds take minutes: they are for those who ask for them.
bool heavy() { return std::getenv("KERVAN_HEAVY") != nullptr; }

std::vector<int> seeds() {
  std::vector<int> seeds{1};
  for (int seed = 2; heavy() && seed <= 10; ++seed) seeds.push_back(seed);
  return seeds;
}

/// The shipped composition with other containers.
std::string placed(const std::string& name, const std::string& containers) {
  std::string text = text_of(fs::path(KERVAN_SOURCES) / "deploy/compositions" / (name + ".yaml"));
  if (const std::size_t from = text.find("\ncontainers:"); from != std::string::npos)
    text.erase(from + 1, text.find("\n\n", from) - from);
  return text + "\ncontainers: " + containers + "\n";
}

struct PlacedRun {
  std::string trace;
  double simulated_s = 0.0;
};

PlacedRun run_placed(const std::string& name, const std::string& containers, int seed) {
  const Folder folder;
  std::ofstream(folder.path() / "c.yaml") << placed(name, containers);
  Command command{KERVAN_PROGRAM, {"run", "c.yaml", "--json", "--arg", "seed=" + std::to_string(seed)}};
  if (!heavy()) command.arguments.insert(command.arguments.end(), {"--for", "5s"});
  const Result result = run(command, folder.path());
  EXPECT_FALSE(result.out.empty()) << result.err;
  if (result.out.empty()) return {};
  const json summary = json::parse(result.out);
  return {summary["trace_hash"], summary["simulated_s"]};
}

class Placement : public testing::TestWithParam<std::tuple<Shipped, int>> {};

TEST_P(Placement, DoesNotChangeTheTrace) {
  const auto& [composition, seed] = GetParam();
  const PlacedRun one = run_placed(composition.name, "{all: {components: [\"**\"]}}", seed);
  EXPECT_FALSE(one.trace.empty());
  for (const char* containers : {composition.in_two, composition.in_five}) {
    const PlacedRun split = run_placed(composition.name, containers, seed);
    EXPECT_EQ(split.trace, one.trace) << containers;
    EXPECT_EQ(split.simulated_s, one.simulated_s);
  }
}

INSTANTIATE_TEST_SUITE_P(Shipped, Placement, testing::Combine(testing::ValuesIn(shipped), testing::ValuesIn(seeds())),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) + "_seed_" +
                                  std::to_string(std::get<1>(test.param));
                         });

}  // namespace
}  // namespace kervan::test
