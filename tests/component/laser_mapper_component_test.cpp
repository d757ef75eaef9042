#include <gtest/gtest.h>

#include <limits>

#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/MapTile.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "tests/component/map_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using kervan_msgs::msg::MapTile;
using sensor_msgs::msg::LaserScan;

/// 181 beams over half a circle, all of one range.
LaserScan scan_of(float range) {
  LaserScan scan;
  scan.angle_min = -1.5707963f;
  scan.angle_max = 1.5707963f;
  scan.angle_increment = 0.01745329f;
  scan.range_min = 0.05f;
  scan.range_max = 8.0f;
  scan.ranges.assign(181, range);
  return scan;
}

void see(Harness& harness, LaserScan scan, int times, double x = 0.025) {
  for (int i = 0; i < times; ++i) {
    scan.header.stamp = geometry::to_message(harness.now());
    harness.feed("odom", odometry_at(harness.now(), {x, 0.025, 0.0}));
    harness.feed("scan", scan);
    harness.advance(50ms);
  }
}

TileMap heard(Harness& harness) {
  TileMap map;
  map.take(harness.take<MapTile>("tiles"));
  return map;
}

TEST(LaserMapperComponent, MapsFromWhereTheLaserIsMounted) {
  Harness harness("mapping/laser", {{"mount", ValueList{1.0, 0.0, 0.0}}, {"start", ValueList{10.0, 0.0, 0.0}}});
  see(harness, scan_of(2.0f), 11);
  const TileMap map = heard(harness);
  EXPECT_GT(map.percent(13.025, 0.025), 90);
  EXPECT_LT(map.percent(12.025, 0.025), 10);
  EXPECT_EQ(map.percent(10.025, 0.025), -1) << "behind the laser";
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(LaserMapperComponent, LeavesOtherRobotsOutOfTheMapWhereTheySayThatTheyAre) {
  Harness harness("mapping/laser", {{"others", ValueList{"r2", "r3"}}});
  for (int i = 0; i < 11; ++i) {
    harness.feed("/r2/odom", odometry_at(harness.now(), {2.2, 0.0, 0.0}));
    see(harness, scan_of(2.0f), 1);
  }
  const TileMap map = heard(harness);
  EXPECT_EQ(map.percent(2.025, 0.025), -1);
  EXPECT_EQ(map.percent(1.025, 0.025), -1) << "nothing is known of what lies before it either";
  EXPECT_GT(map.percent(0.025, 2.025), 90);
  EXPECT_EQ(harness.state(), ComponentState::active) << "nobody knows where r3 is";
  // r2 is silent: what is there may be anything.
  harness.advance(1s);
  see(harness, scan_of(2.0f), 11);
  EXPECT_GT(heard(harness).percent(2.025, 0.025), 90);
}

TEST(LaserMapperComponent, LeavesOutWhatIsNoDistanceAndSaysSo) {
  Harness harness("mapping/laser");
  see(harness, scan_of(std::numeric_limits<float>::quiet_NaN()), 11);
  EXPECT_EQ(harness.reason(), "scan: ranges that are no distance are left out");
  EXPECT_TRUE(heard(harness).tiles.empty());
  see(harness, scan_of(-std::numeric_limits<float>::infinity()), 21);
  EXPECT_EQ(harness.state(), ComponentState::active) << "too near is no fault";
}

TEST(LaserMapperComponent, LeavesOutScansThatCannotBe) {
  Harness harness("mapping/laser");
  LaserScan scan = scan_of(2.0f);
  scan.angle_increment = 0.0f;
  see(harness, scan, 11);
  EXPECT_EQ(harness.reason(), "scan: its angles or limits are none");
  EXPECT_TRUE(heard(harness).tiles.empty());
}

TEST(LaserMapperComponent, DoesNotGrowBeyondItsMemory) {
  Harness harness("mapping/laser", {{"memory", 0.1}});
  see(harness, scan_of(2.0f), 11);
  see(harness, scan_of(2.0f), 21, 1000.0);
  EXPECT_EQ(harness.reason(), "the map may not grow any more, memory is used up: scans beyond it are left out");
  EXPECT_GT(heard(harness).percent(2.025, 0.025), 90);
}

TEST(LaserMapperComponent, LeavesOutScansWithoutAPoseOfTheirTime) {
  Harness harness("mapping/laser");
  harness.advance(2s);
  LaserScan scan = scan_of(2.0f);
  scan.header.stamp = geometry::to_message(Time(1s));
  harness.feed("odom", odometry_at(harness.now(), {}));
  harness.feed("scan", scan);
  harness.advance(500ms);
  EXPECT_EQ(harness.reason(), "scan: scans without a pose of their time are left out");
  EXPECT_TRUE(heard(harness).tiles.empty());
}

}  // namespace
}  // namespace kervan::test
