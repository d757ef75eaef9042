// The controllers that look at a laser's scans.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <string>

#include "framework/test/harness.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::TwistStamped;
using sensor_msgs::msg::LaserScan;

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// 181 beams, one a degree, that all see `range`.
LaserScan scan_of(double range) {
  LaserScan scan;
  scan.header.frame_id = "laser";
  scan.angle_min = static_cast<float>(-0.5 * std::numbers::pi);
  scan.angle_max = -scan.angle_min;
  scan.angle_increment = static_cast<float>(std::numbers::pi / 180.0);
  scan.range_min = 0.05F;
  scan.range_max = 30.0F;
  scan.ranges.assign(181, static_cast<float>(range));
  return scan;
}

/// As scan_of(inf), but the beams from `first` to `last` degrees from straight ahead see `range`.
LaserScan scan_with(int first, int last, double range) {
  LaserScan scan = scan_of(inf);
  std::fill(scan.ranges.begin() + 90 + first, scan.ranges.begin() + 91 + last, static_cast<float>(range));
  return scan;
}

struct LaserDrive {
  explicit LaserDrive(const std::string& type, const ValueMap& parameters = {}) : harness(type, parameters) {
    harness.feed("waypoint", pose_at(9.0, 0.0));
  }

  void feed(const LaserScan& scan, const geometry::Pose2& robot = {}, const geometry::Twist2& moving = {}) {
    harness.feed("odom", odometry_at(robot, moving));
    harness.feed("scan", scan);
    harness.advance(100ms);
  }
  const geometry_msgs::msg::Twist& command() const { return harness.latest<TwistStamped>("cmd_vel_raw")->twist; }
  void expect_stands(const char* why) const {
    EXPECT_EQ(command().linear.x, 0.0) << why;
    EXPECT_EQ(command().angular.z, 0.0) << why;
    EXPECT_EQ(harness.state(), ComponentState::degraded) << why;
    EXPECT_EQ(harness.reason(), why);
  }

  Harness harness;
};

class LaserControllers : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(All, LaserControllers, testing::Values("control/vfh_openings", "control/vfh_plus"),
                         [](const auto& with) { return std::string(with.param).substr(8); });

TEST_P(LaserControllers, DrivesStraightAtAWaypointAheadInTheOpen) {
  LaserDrive drive(GetParam());
  drive.feed(scan_of(inf));
  EXPECT_NEAR(drive.command().linear.x, 0.6, 1e-12);
  EXPECT_NEAR(drive.command().angular.z, 0.0, 1e-6);
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
  EXPECT_EQ(drive.harness.latest<TwistStamped>("cmd_vel_raw")->header.frame_id, "base_link");
}

TEST_P(LaserControllers, StandsAndSaysWhichInputIsMissing) {
  Harness harness(GetParam());
  harness.advance(0ms);
  harness.feed("waypoint", pose_at(3.0, 0.0));
  harness.feed("odom", odometry_at({}));
  harness.advance(100ms);
  EXPECT_EQ(harness.reason(), "scan: nothing received yet");
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel_raw")->twist.linear.x, 0.0);
}

TEST_P(LaserControllers, StandsWhenTheScansStop) {
  LaserDrive drive(GetParam());
  drive.feed(scan_of(inf));
  EXPECT_GT(drive.command().linear.x, 0.0);
  for (int i = 0; i < 7; ++i) {
    drive.harness.feed("odom", odometry_at({}));
    drive.harness.advance(100ms);
  }
  drive.expect_stands("scan: no sample for more than 0.50 s");
}

TEST_P(LaserControllers, StandsAndSaysWhatIsWrongWithAnInput) {
  LaserDrive drive(GetParam());
  LaserScan scan = scan_of(inf);
  scan.angle_increment = 0.0F;
  drive.feed(scan);
  drive.expect_stands("scan: its angles or limits are none");
  drive.feed(scan_of(inf), {nan, 0.0, 0.0});
  drive.expect_stands("odom: the pose is not finite");
  drive.feed(scan_of(inf), {}, {nan, 0.0});
  drive.expect_stands("odom: the speed is not finite");
  drive.feed(scan_of(inf));
  drive.feed(scan_of(inf));
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
  drive.harness.feed("waypoint", pose_at(nan, 0.0));
  drive.feed(scan_of(inf));
  drive.expect_stands("waypoint: the position is not finite");
}

TEST_P(LaserControllers, StandsStillAtItsWaypointUntilTheNextComes) {
  LaserDrive drive(GetParam());
  drive.feed(scan_of(inf), {8.95, 0.0, 0.0});
  EXPECT_EQ(drive.command().linear.x, 0.0);
  drive.harness.feed("waypoint", pose_at(12.0, 0.0));
  drive.feed(scan_of(inf), {8.95, 0.0, 0.0});
  EXPECT_GT(drive.command().linear.x, 0.0);
  drive.harness.end();
  EXPECT_EQ(drive.command().linear.x, 0.0) << "its last word";
}

TEST(VfhOpeningsComponent, TurnsIntoTheOpening) {
  LaserDrive drive("control/vfh_openings");
  drive.feed(scan_with(-90, 20, 1.0));
  EXPECT_GT(drive.command().angular.z, 0.0);
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
}

TEST(VfhOpeningsComponent, TurnsOnTheSpotWithoutAnOpeningAndSaysSo) {
  LaserDrive drive("control/vfh_openings");
  drive.feed(scan_of(1.0));
  EXPECT_EQ(drive.command().linear.x, 0.0);
  EXPECT_EQ(drive.command().angular.z, 0.75);
  EXPECT_EQ(drive.harness.state(), ComponentState::degraded);
  EXPECT_EQ(drive.harness.reason(), "no opening is wide enough: it turns to find one");
  drive.feed(scan_of(inf));
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
}

TEST(VfhOpeningsComponent, StandsBeforeAScanThatLeavesOutDegrees) {
  LaserDrive drive("control/vfh_openings");
  LaserScan narrow = scan_of(inf);
  narrow.ranges.resize(100);
  drive.feed(narrow);
  drive.expect_stands("scan: it does not cover 180 degrees ahead");
}

TEST(VfhOpeningsComponent, RefusesThreeWeightsOfZero) {
  try {
    Harness harness("control/vfh_openings", {{"a", 0.0}, {"b", 0.0}, {"c", 0.0}});
    FAIL();
  } catch (const ParameterError& error) {
    EXPECT_EQ(error.message(), "a, b and c are all zero, so no opening would be better than another");
  }
}

}  // namespace
}  // namespace kervan::test
