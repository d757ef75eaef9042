#include <gtest/gtest.h>

#include <limits>

#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/MapRequest.hpp"
#include "kervan_msgs/msg/MapTile.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/OccupancyGrid.hpp"
#include "tests/component/map_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using kervan_msgs::msg::MapRequest;
using kervan_msgs::msg::MapTile;
using kervan_msgs::msg::SonarArray;
using nav_msgs::msg::OccupancyGrid;

/// One sonar in base_link, looking ahead.
SonarArray echo(Time stamp, float range) {
  SonarArray array;
  geometry::set_header(array.header, stamp, "r1/base_link");
  array.field_of_view = 0.5235988f;
  array.min_range = 0.15f;
  array.max_range = 5.0f;
  array.readings.resize(1);
  array.readings[0].range = range;
  return array;
}

void hear(Harness& harness, double x, float range, int times) {
  for (int i = 0; i < times; ++i) {
    harness.feed("odom", odometry_at(harness.now(), {x, 0.025, 0.0}));
    harness.feed("sonar", echo(harness.now(), range));
    harness.advance(50ms);
  }
}

ValueMap coarse() { return {{"resolution", 0.1}, {"tolerance", 0.05}}; }

TEST(SonarMapperComponent, PublishesTheTilesThatHaveChanged) {
  Harness harness("mapping/sonar", coarse());
  hear(harness, 0.05, 2.0f, 11);
  TileMap map;
  const auto tiles = harness.take<MapTile>("tiles");
  map.take(tiles);
  EXPECT_EQ(map.session, 0u);
  EXPECT_GT(map.percent(2.05, 0.05), 80);
  EXPECT_LT(map.percent(1.05, 0.05), 20);
  EXPECT_EQ(map.percent(2.55, 0.05), -1);
  for (const auto& tile : tiles) EXPECT_EQ(tile->header.frame_id, "map");
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(SonarMapperComponent, SaysNothingAboutTilesThatLookAsTheyDid) {
  ValueMap params = coarse();
  params["update"] = "himm";
  Harness harness("mapping/sonar", params);
  hear(harness, 0.05, 2.0f, 30);  // surer it cannot become
  harness.take<MapTile>("tiles");
  hear(harness, 0.05, 2.0f, 40);
  EXPECT_TRUE(harness.take<MapTile>("tiles").empty());
  hear(harness, 0.05, 3.0f, 20);
  EXPECT_FALSE(harness.take<MapTile>("tiles").empty());
}

TEST(SonarMapperComponent, GivesTheWholeMapToWhoeverAsks) {
  Harness harness("mapping/sonar", coarse());
  hear(harness, 0.05, 2.0f, 11);
  EXPECT_FALSE(harness.latest<OccupancyGrid>("map"));
  harness.feed("map_request", MapRequest());
  hear(harness, 0.05, 2.0f, 11);
  const auto* map = harness.latest<OccupancyGrid>("map");
  ASSERT_TRUE(map);
  EXPECT_EQ(map->info.resolution, 0.1f);
  EXPECT_EQ(map->data.size(), std::size_t{map->info.width} * map->info.height);
  const auto column = static_cast<std::size_t>((2.05 - map->info.origin.position.x) / 0.1);
  const auto row = static_cast<std::size_t>((0.05 - map->info.origin.position.y) / 0.1);
  EXPECT_GT(map->data[row * map->info.width + column], 80);
  harness.advance(5s);
  EXPECT_EQ(harness.take<OccupancyGrid>("map").size(), 1u) << "once";
}

TEST(SonarMapperComponent, TakesThePoseAtTheTimeOfTheReading) {
  Harness harness("mapping/sonar", coarse());
  harness.feed("odom", odometry_at(Time(0ms), {0.0, 0.05, 0.0}));
  harness.advance(50ms);
  harness.feed("sonar", echo(Time(25ms), 2.0f));
  harness.advance(10ms);
  harness.feed("odom", odometry_at(Time(50ms), {1.1, 0.05, 0.0}));
  harness.advance(500ms);
  TileMap map;
  map.take(harness.take<MapTile>("tiles"));
  EXPECT_GT(map.percent(2.55, 0.05), 50) << "at 25 ms the robot was at 0.55";
}

TEST(SonarMapperComponent, BeginsWhereTheRobotIsKnownToStart) {
  ValueMap params = coarse();
  params["start"] = ValueList{10.0, 20.0, 1.5707963267948966};
  Harness harness("mapping/sonar", params);
  hear(harness, 0.05, 2.0f, 11);
  TileMap map;
  map.take(harness.take<MapTile>("tiles"));
  EXPECT_GT(map.percent(9.97, 22.05), 80);
}

TEST(SonarMapperComponent, LeavesOutWhatIsNoDistanceAndSaysSo) {
  Harness harness("mapping/sonar", coarse());
  for (const float range : {-1.0f, 0.01f}) {
    hear(harness, 0.05, range, 11);
    EXPECT_EQ(harness.state(), ComponentState::degraded);
    EXPECT_EQ(harness.reason(), "sonar: ranges that are no distance are left out");
  }
  EXPECT_TRUE(harness.take<MapTile>("tiles").empty());
  hear(harness, 0.05, 2.0f, 21);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(SonarMapperComponent, SaysNothingOfASonarThatHadNotItsTurn) {
  Harness harness("mapping/sonar", coarse());
  hear(harness, 0.05, std::numeric_limits<float>::quiet_NaN(), 11);
  EXPECT_EQ(harness.state(), ComponentState::active);
  EXPECT_TRUE(harness.take<MapTile>("tiles").empty());
}

TEST(SonarMapperComponent, LeavesOutAnArrayThatDoesNotFitTheRobot) {
  Harness harness("mapping/sonar", coarse());
  const auto refused = [&](SonarArray array) {
    for (int i = 0; i < 11; ++i) {
      harness.feed("odom", odometry_at(harness.now(), {}));
      geometry::set_header(array.header, harness.now(), "");
      harness.feed("sonar", array);
      harness.advance(50ms);
    }
    EXPECT_TRUE(harness.take<MapTile>("tiles").empty());
    return harness.state() == ComponentState::degraded ? harness.reason() : "";
  };
  SonarArray array = echo({}, 2.0f);
  array.field_of_view = 0.3f;
  EXPECT_EQ(refused(array), "sonar: its cones do not open as wide as twice half_aperture");
  array = echo({}, 2.0f);
  array.max_range = 0.1f;
  EXPECT_EQ(refused(array), "sonar: its ranges are none");
  array = echo({}, 2.0f);
  array.readings[0].x = 11.0f;
  EXPECT_EQ(refused(array), "sonar: a sonar of it is not on the robot");
  hear(harness, 0.05, 2.0f, 11);
  harness.advance(500ms);
  harness.take<MapTile>("tiles");
  array = echo({}, 2.0f);
  array.readings.resize(2);
  EXPECT_EQ(refused(array), "sonar: it has not as many sonars as before");
}

TEST(SonarMapperComponent, LeavesOutReadingsWithoutAPoseOfTheirTime) {
  Harness harness("mapping/sonar", coarse());
  harness.advance(2s);
  harness.feed("sonar", echo(Time(1s), 2.0f));
  harness.feed("odom", odometry_at(harness.now(), {}));
  harness.advance(500ms);
  EXPECT_TRUE(harness.take<MapTile>("tiles").empty());
  EXPECT_EQ(harness.reason(), "sonar: readings without a pose of their time are left out");
}

TEST(SonarMapperComponent, DoesNotGrowBeyondItsMemory) {
  ValueMap params = coarse();
  params["memory"] = 0.1;
  Harness harness("mapping/sonar", params);
  hear(harness, 0.05, 2.0f, 11);
  harness.advance(500ms);
  harness.take<MapTile>("tiles");
  hear(harness, 1000.0, 2.0f, 11);
  EXPECT_EQ(harness.reason(), "the map may not grow any more, memory is used up: readings beyond it are left out");
  EXPECT_TRUE(harness.take<MapTile>("tiles").empty());
  hear(harness, 0.05, 2.0f, 21);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(SonarMapperComponent, SaysWhatItMisses) {
  Harness harness("mapping/sonar", coarse());
  harness.advance(600ms);
  EXPECT_EQ(harness.reason(), "odom: nothing received yet");
  harness.feed("odom", odometry_at(harness.now(), {}));
  harness.advance(500ms);
  EXPECT_EQ(harness.reason(), "sonar: nothing received yet");
}

TEST(SonarMapperComponent, MapsByEachRule) {
  for (const char* update : {"bayes", "dempster_shafer", "himm"}) {
    ValueMap params = coarse();
    params["update"] = update;
    Harness harness("mapping/sonar", params);
    hear(harness, 0.05, 2.0f, 11);
    TileMap map;
    map.take(harness.take<MapTile>("tiles"));
    EXPECT_GT(map.percent(2.05, 0.05), 80) << update;
  }
}

}  // namespace
}  // namespace kervan::test
