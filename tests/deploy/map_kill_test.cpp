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

const std::string mapper =
    "mapper: {type: mapping/sonar, params: {period: 100ms}, remap: {odom: /r1/odom, sonar: /r1/sonar, tiles: "
    "/r1/tiles, "
    "map: /r1/map, map_request: /r1/map_request}}";
const std::string keeper =
    "keeper: {type: mapping/keeper, params: {sources: [r1], period: 100ms, checkpoint_period: 0.2 s}}";

/// Cells that a map knows.
std::size_t known(const std::vector<std::int8_t>& percent) {
  return static_cast<std::size_t>(std::count_if(percent.begin(), percent.end(), [](std::int8_t p) { return p >= 0; }));
}

/// What the keeper has on disk now; every file that is ever there under this name must be whole.
std::size_t known_on_disk(const Supervised& run) {
  if (!std::filesystem::exists(run.folder() / "runs")) return 0;  // it has not begun
  const std::string bytes = run.file("keeper.map");
  if (bytes.empty()) return 0;
  mapping::MapMerger map({"r1"}, 0.05, std::size_t{1} << 28);
  map.restore(grid::checkpoint_of(bytes), "");
  std::vector<std::int8_t> percent(static_cast<std::size_t>(map.box().columns) *
                                   static_cast<std::size_t>(map.box().rows));
  map.read_percent(map.box(), percent);
  return known(percent);
}

TEST(MapKill, NeitherTheMappersDeathNorTheKeepersLosesTheMap) {
  Supervised run(
      lab_over({{"sim", "[world, report, mission]"}, {"robot", "[r1]"}, {"mapper", "[mapper]"}, {"keeper", "[keeper]"}},
               {mapper, keeper}),
      "sim");
  ASSERT_TRUE(eventually([&] { return known_on_disk(run) > 1000; })) << run.said();

  std::size_t before = known_on_disk(run);
  ::kill(run.container("mapper"), SIGKILL);
  run.wait_for("the container mapper died of SIGKILL");
  ASSERT_TRUE(eventually([&] {
    const std::size_t now = known_on_disk(run);
    EXPECT_GE(now, before) << "something was forgotten";
    return now > before + 500;
  })) << "the new mapper's tiles are not added\n"
      << run.said();

  before = known_on_disk(run);
  ::kill(run.container("keeper"), SIGKILL);
  run.wait_for("the container keeper is active again");
  ASSERT_TRUE(eventually([&] {
    const std::size_t now = known_on_disk(run);
    EXPECT_GE(now, before) << "something was forgotten";
    return now > before;
  })) << run.said();

  before = known_on_disk(run);
  run.signal(SIGTERM);
  run.wait();
  for (const auto& entry : std::filesystem::directory_iterator(run.folder() / "runs"))
    EXPECT_GE(known(map_file::load((entry.path() / "keeper.yaml").string()).occupancy), before / 2)
        << "of cells, in trinary those in doubt are not counted";
}

}  // namespace
}  // namespace kervan::test
