#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "framework/map_file/map_file.hpp"
#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/MapRequest.hpp"
#include "kervan_msgs/msg/MapTile.hpp"
#include "nav_msgs/msg/OccupancyGrid.hpp"
#include "tests/component/map_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using kervan_msgs::msg::MapTile;
namespace fs = std::filesystem;

class MapKeeperComponent : public testing::Test {
 protected:
  MapKeeperComponent() { fs::create_directories(folder_); }
  ~MapKeeperComponent() override { fs::remove_all(folder_); }

  ValueMap two() const {
    return {{"sources", ValueList{std::string("r1"), std::string("r2")}}, {"checkpoint_period", 1.0}};
  }
  fs::path checkpoint() const { return folder_ / "subject.map"; }
  /// The file as it is now, as a killed process leaves it, survives the end of the harness.
  std::string bytes() const {
    std::ifstream file(checkpoint(), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void write(const std::string& bytes) const { std::ofstream(checkpoint(), std::ios::binary) << bytes; }

  fs::path folder_ = fs::temp_directory_path() / ("kervan_keeper_" + std::to_string(getpid()));
};

TileMap heard(Harness& harness) {
  TileMap map;
  map.take(harness.take<MapTile>("tiles"));
  return map;
}

TEST_F(MapKeeperComponent, MergesTheMapsOfTwoRobots) {
  Harness harness("mapping/keeper", two());
  harness.feed("r1/tiles", map_tile({0, 0}, {60, 30}));
  harness.feed("r2/tiles", map_tile({0, 0}, {70}));
  harness.feed("r2/tiles", map_tile({-1, 2}, {90}));
  harness.advance(600ms);
  const TileMap map = heard(harness);
  EXPECT_EQ(map.tiles.size(), 2u);
  EXPECT_EQ(map.percent(0.01, 0.01), 78);
  EXPECT_EQ(map.percent(0.06, 0.01), 30);
  EXPECT_EQ(map.percent(-3.19, 6.41), 90);
  EXPECT_EQ(harness.state(), ComponentState::active);
  harness.advance(5s);
  EXPECT_TRUE(harness.take<MapTile>("tiles").empty()) << "nothing has changed";
}

TEST_F(MapKeeperComponent, KeepsTheMapOfAMapperThatWasStartedAgain) {
  Harness harness("mapping/keeper", two());
  harness.feed("r1/tiles", map_tile({0, 0}, {60, 30}, 1));
  harness.advance(600ms);
  harness.feed("r1/tiles", map_tile({0, 0}, {-1, 30}, 2));
  harness.advance(600ms);
  const TileMap map = heard(harness);
  EXPECT_EQ(map.percent(0.01, 0.01), 60);
  EXPECT_EQ(map.percent(0.06, 0.01), 16);
}

TEST_F(MapKeeperComponent, GoesOnFromItsCheckpointAfterItWasKilled) {
  std::string kept;
  {
    Harness harness("mapping/keeper", two(), folder_);
    harness.feed("r1/tiles", map_tile({0, 0}, {60}, 1));
    harness.advance(2s);
    kept = bytes();
    ASSERT_FALSE(kept.empty());
    harness.feed("r1/tiles", map_tile({0, 0}, {99}, 1));
    harness.advance(100ms);
  }
  write(kept);
  Harness harness("mapping/keeper", two(), folder_);
  harness.advance(100ms);
  EXPECT_EQ(heard(harness).percent(0.01, 0.01), 60) << "for whoever listens, before any mapper has said anything";
  harness.feed("r1/tiles", map_tile({0, 0}, {70}, 1));  // the mapper lives, and its tiles come again
  harness.advance(600ms);
  EXPECT_EQ(heard(harness).percent(0.01, 0.01), 70);
}

TEST_F(MapKeeperComponent, PutsACheckpointAsideThatItCannotRead) {
  {
    Harness harness("mapping/keeper", two(), folder_);
    harness.feed("r1/tiles", map_tile({0, 0}, {60}, 1));
    harness.advance(2s);
  }
  const std::string good = bytes();
  write(good.substr(0, good.size() / 2));
  const std::string file = checkpoint().string();
  {
    Harness harness("mapping/keeper", two(), folder_);
    harness.advance(600ms);
    EXPECT_EQ(harness.state(), ComponentState::degraded);
    EXPECT_EQ(harness.reason(), "began with an empty map: " + file + ": the checkpoint is cut off: it has " +
                                    std::to_string(good.size() / 2) + " of " + std::to_string(good.size()) +
                                    " bytes; it is kept as " + file + ".refused");
    EXPECT_TRUE(heard(harness).tiles.empty());
    harness.feed("r1/tiles", map_tile({0, 0}, {80}, 1));
    harness.advance(2s);
  }
  EXPECT_EQ(fs::file_size(file + ".refused"), good.size() / 2);
  std::string newer = good;
  newer[8] = 9;
  write(newer);
  Harness harness("mapping/keeper", two(), folder_);
  harness.advance(600ms);
  EXPECT_EQ(harness.reason(), "began with an empty map: " + file +
                                  ": the checkpoint is of version 9 of the format; allowed: 1; it is kept as " + file +
                                  ".refused-2");
}

TEST_F(MapKeeperComponent, KeepsAMapBeyondTheRunInAFileOfItsOwn) {
  ValueMap params = two();
  params["file"] = (folder_ / "hall.map").string();
  const fs::path first = folder_ / "first", second = folder_ / "second";
  fs::create_directories(first);
  fs::create_directories(second);
  {
    Harness harness("mapping/keeper", params, first);
    harness.feed("r1/tiles", map_tile({0, 0}, {60}, 0));
    harness.advance(600ms);
  }
  Harness harness("mapping/keeper", params, second);
  harness.feed("r1/tiles", map_tile({0, 0}, {70}, 0));
  harness.advance(600ms);
  EXPECT_EQ(heard(harness).percent(0.01, 0.01), 78) << "another run's evidence is added to";
}

TEST_F(MapKeeperComponent, LeavesAMapForMapServer) {
  {
    Harness harness("mapping/keeper", two(), folder_);
    harness.feed("r1/tiles", map_tile({0, 0}, {90, 10}));
    harness.advance(600ms);
  }
  const map_file::GridMap map = map_file::load((folder_ / "subject.yaml").string());
  EXPECT_EQ(map.resolution, 0.05);
  EXPECT_EQ(map.occupancy[0], 100);
  EXPECT_EQ(map.occupancy[1], 0);
  EXPECT_EQ(map.occupancy[2], -1);
}

TEST_F(MapKeeperComponent, LeavesThePictureInTheFormatThatIsAskedFor) {
  {
    ValueMap params = two();
    params["image"] = "pgm";
    Harness harness("mapping/keeper", params, folder_);
    harness.feed("r1/tiles", map_tile({0, 0}, {90, 10}));
    harness.advance(600ms);
  }
  EXPECT_TRUE(fs::exists(folder_ / "subject.pgm"));
  EXPECT_EQ(map_file::load((folder_ / "subject.yaml").string()).occupancy[0], 100);
}

TEST_F(MapKeeperComponent, LeavesOutTilesThatDoNotFitAndKeepsTheRest) {
  Harness harness("mapping/keeper", two());
  harness.advance(10ms);  // from here on one tick in each half second
  harness.feed("r2/tiles", map_tile({0, 0}, {60}));
  MapTile tile = map_tile({1, 1}, {60});
  tile.resolution = 0.1f;
  harness.feed("r1/tiles", tile);
  harness.advance(500ms);
  EXPECT_EQ(harness.reason(), "r1/tiles: cells of another size are left out");
  tile = map_tile({1, 1}, {60});
  tile.data.resize(10);
  harness.feed("r1/tiles", tile);
  harness.advance(500ms);
  EXPECT_EQ(harness.reason(), "r1/tiles: tiles of another size are left out");
  tile = map_tile({1, 1}, {120});
  harness.feed("r1/tiles", tile);
  harness.advance(500ms);
  EXPECT_EQ(harness.reason(), "r1/tiles: a percentage is none, its tile is left out");
  harness.feed("r1/tiles", map_tile({1 << 20, 1}, {50}));
  harness.advance(500ms);
  EXPECT_EQ(harness.reason(), "the map may not grow any more, memory is used up: tiles beyond it are left out");
  EXPECT_EQ(heard(harness).percent(0.01, 0.01), 60);
}

TEST_F(MapKeeperComponent, SaysWhichMapperHasSaidNothing) {
  Harness harness("mapping/keeper", two());
  harness.feed("r1/tiles", map_tile({0, 0}, {60}));
  harness.advance(1900ms);
  EXPECT_EQ(harness.reason(), "") << "it may still come";
  harness.advance(200ms);
  EXPECT_EQ(harness.reason(), "r2/tiles: nothing received yet");
}

TEST_F(MapKeeperComponent, RefusesTwoMappersOfOneName) {
  try {
    Harness("mapping/keeper", {{"sources", ValueList{std::string("r1"), std::string("r1")}}});
    FAIL() << "it was taken";
  } catch (const ParameterError& error) {
    EXPECT_EQ(error.parameter(), "subject.sources[1]");
    EXPECT_EQ(error.message(), "'r1' is there already; name each mapper once");
  }
}

}  // namespace
}  // namespace kervan::test
