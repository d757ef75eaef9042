// A map outlives whoever makes it and whoever keeps it.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>

#include "components/mapping/map_merger.hpp"
#include "framework/map_file/map_file.hpp"
#include "tests/deploy/supervised.hpp"
#include "tests/program/eventually.hpp"

namespace kervan::test {
namespace {

const std::string mapper_line =
    "mapper: {type: mapping/sonar, params: {period: 100ms}, remap: {odom: /r1/odom, sonar: /r1/sonar, tiles: "
    "/r1/tiles, "
    "map: /r1/map, map_request: /r1/map_request}}";
const std::string keeper_line =
    "keeper: {type: mapping/keeper, params: {sources: [r1], period: 100ms, checkpoint_period: 0.2 s}}";

/// Cells that a map knows.
std::size_t known(const std::vector<std::int8_t>& percent) {
  return static_cast<std::size_t>(std::count_if(percent.begin(), percent.end(), [](std::int8_t p) { return p >= 0; }));
}

/// What the keeper of this name has on disk now; every file that is ever there must be whole.
std::size_t known_on_disk(const Supervised& run, const std::string& keeper) {
  if (!std::filesystem::exists(run.folder() / "runs")) return 0;  // it has not begun
  const std::string bytes = run.file(keeper + ".map");
  if (bytes.empty()) return 0;
  mapping::MapMerger map({}, 0.05, std::size_t{1} << 28);
  map.restore(grid::checkpoint_of(bytes), "");
  std::vector<std::int8_t> percent(static_cast<std::size_t>(map.box().columns) *
                                   static_cast<std::size_t>(map.box().rows));
  map.read_percent(map.box(), percent);
  return known(percent);
}

/// Kills the container `mapper`, then the container `keeper`, in which the keeper of that name is.
void expect_nothing_forgotten(Supervised& run, const std::string& mapper, const std::string& keeper) {
  ASSERT_TRUE(eventually([&] { return known_on_disk(run, keeper) > 1000; })) << run.said();

  std::size_t before = known_on_disk(run, keeper);
  ::kill(run.container(mapper), SIGKILL);
  run.wait_for("the container " + mapper + " died of SIGKILL");
  ASSERT_TRUE(eventually([&] {
    const std::size_t now = known_on_disk(run, keeper);
    EXPECT_GE(now, before) << "something was forgotten";
    return now > before + 500;
  })) << "the new mapper's tiles are not added\n"
      << run.said();

  before = known_on_disk(run, keeper);
  ::kill(run.container(keeper), SIGKILL);
  run.wait_for("the container " + keeper + " is active again");
  ASSERT_TRUE(eventually([&] {
    const std::size_t now = known_on_disk(run, keeper);
    EXPECT_GE(now, before) << "something was forgotten";
    return now > before;
  })) << run.said();

  before = known_on_disk(run, keeper);
  run.signal(SIGTERM);
  run.wait();
  for (const auto& entry : std::filesystem::directory_iterator(run.folder() / "runs"))
    EXPECT_GE(known(map_file::load((entry.path() / (keeper + ".yaml")).string()).occupancy), before / 2)
        << "of cells, in trinary those in doubt are not counted";
}

TEST(MapKill, NeitherTheMappersDeathNorTheKeepersLosesTheMap) {
  Supervised run(
      lab_over({{"sim", "[world, report, mission]"}, {"robot", "[r1]"}, {"mapper", "[mapper]"}, {"keeper", "[keeper]"}},
               {mapper_line, keeper_line}),
      "sim");
  expect_nothing_forgotten(run, "mapper", "keeper");
}

TEST(MapKill, AKeeperThatComesLateGetsTheWholeMapOfAMapperThatLives) {
  Supervised run(
      lab_over({{"sim", "[world, report, mission]"}, {"robot", "[r1]"}, {"mapper", "[mapper]"}, {"keeper", "[keeper]"}},
               {mapper_line, keeper_line}),
      "sim");
  ASSERT_TRUE(eventually([&] { return known_on_disk(run, "keeper") > 5000; })) << run.said();
  const std::size_t before = known_on_disk(run, "keeper");
  ::kill(run.container("keeper"), SIGKILL);
  for (const auto& entry : std::filesystem::directory_iterator(run.folder() / "runs"))
    std::filesystem::remove(entry.path() / "keeper.map");  // it will know nothing
  run.wait_for("the container keeper is active again");
  EXPECT_TRUE(eventually([&] { return known_on_disk(run, "keeper") >= before; })) << run.said();
  run.signal(SIGTERM);
  run.wait();
}

/// The shipped composition, its keeper writing more often.
std::string two_robots() {
  std::string text = text_of(std::filesystem::path(KERVAN_SOURCES) / "deploy/compositions/12_map_two_robots.yaml");
  const auto replace = [&](const std::string& part, const std::string& with) {
    const auto at = text.find(part);
    if (at == std::string::npos) throw std::runtime_error("there is no '" + part + "' in it");
    text.replace(at, part.size(), with);
  };
  const auto clock = text.find("  clock:");
  text.erase(clock, text.find('\n', clock) + 1 - clock);
  replace("\nclock: {mode: \"${clock}\", step: 10ms}\n", "\n");
  replace("sources: [r1, r2]", "sources: [r1, r2], checkpoint_period: 0.2 s");
  return text.substr(text.find("\nargs:") + 1);
}

TEST(MapKill, OfTwoRobotsOneMayDieAndTheKeeperToo) {
  Supervised run(two_robots(), "sim");
  expect_nothing_forgotten(run, "r1", "map");
}

}  // namespace
}  // namespace kervan::test
