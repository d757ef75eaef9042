#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::TwistStamped;
using sensor_msgs::msg::LaserScan;

constexpr float infinity = std::numeric_limits<float>::infinity();

/// Three beams: to the right, ahead and to the left.
LaserScan scan_of(float ahead) {
  LaserScan scan;
  scan.angle_min = -1.5F;
  scan.angle_increment = 1.5F;
  scan.range_min = 0.1F;
  scan.range_max = 8.0F;
  scan.ranges = {infinity, ahead, infinity};
  return scan;
}

kervan_msgs::msg::SonarArray sonar_of(float ahead) {
  kervan_msgs::msg::SonarArray sonar;
  sonar.field_of_view = 0.5F;
  sonar.min_range = 0.15F;
  sonar.max_range = 5.0F;
  sonar.readings.resize(1);
  sonar.readings[0].x = 0.2F;
  sonar.readings[0].range = ahead;
  return sonar;
}

/// What is left of the command.
geometry::Twist2 checked(Harness& harness, double linear, double angular = 0.0) {
  harness.feed("cmd_vel_raw", twist_of(linear, angular));
  harness.advance(10ms);
  return geometry::twist_of(harness.latest<TwistStamped>("cmd_vel_checked")->twist);
}

TEST(CollisionMonitorComponent, PassesCommandsAtOnceWhereNothingIsNear) {
  Harness harness("safety/collision_monitor");
  harness.feed("scan", scan_of(infinity));
  EXPECT_EQ(checked(harness, 1.2, 0.3), (geometry::Twist2{1.2, 0.3}));
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel_checked")->header.frame_id, "base_link");
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(CollisionMonitorComponent, SlowsAndStopsBeforeWhatTheLaserSees) {
  Harness harness("safety/collision_monitor");
  harness.feed("scan", scan_of(0.6F));
  const double slow = checked(harness, 1.0).linear;
  EXPECT_GT(slow, 0.1);
  EXPECT_LT(slow, 0.9);
  harness.feed("scan", scan_of(0.275F));
  EXPECT_EQ(checked(harness, 1.0).linear, 0.0);
  EXPECT_EQ(harness.state(), ComponentState::degraded);
  EXPECT_EQ(harness.reason(), "cmd_vel_raw: stopped, it would collide");
  EXPECT_EQ(checked(harness, -0.2).linear, -0.2) << "away from it";
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(CollisionMonitorComponent, KnowsWhereItsLaserSits) {
  Harness harness("safety/collision_monitor", {{"mount", ValueList{0.25, 0.0, 0.0}}});
  harness.feed("scan", scan_of(0.7F));
  EXPECT_EQ(checked(harness, 1.0).linear, 1.0);
}

TEST(CollisionMonitorComponent, WhatIsTooNearToBeMeasuredIsNoFartherThanThat) {
  Harness harness("safety/collision_monitor", {{"mount", ValueList{0.17, 0.0, 0.0}}});
  harness.feed("scan", scan_of(-infinity));
  EXPECT_EQ(checked(harness, 0.5).linear, 0.0);
}

TEST(CollisionMonitorComponent, StopsWithoutAFreshScan) {
  Harness harness("safety/collision_monitor");
  EXPECT_EQ(checked(harness, 1.0).linear, 0.0);
  EXPECT_EQ(harness.reason(), "scan: nothing received yet");
  harness.feed("scan", scan_of(infinity));
  EXPECT_EQ(checked(harness, 1.0).linear, 1.0);
  harness.advance(600ms);
  EXPECT_EQ(checked(harness, 1.0).linear, 0.0);
  EXPECT_EQ(harness.state(), ComponentState::degraded);
}

TEST(CollisionMonitorComponent, RefusesAScanThatIsNone) {
  Harness harness("safety/collision_monitor");
  LaserScan scan = scan_of(infinity);
  scan.angle_increment = 0.0F;
  harness.feed("scan", scan);
  EXPECT_EQ(checked(harness, 1.0).linear, 0.0);
  EXPECT_EQ(harness.reason(), "scan: its angles or limits are none");
}

TEST(CollisionMonitorComponent, HearsSonarsIfItIsToldTo) {
  Harness harness("safety/collision_monitor", {{"sensor", "sonar"}});
  harness.feed("scan", scan_of(infinity));
  EXPECT_EQ(checked(harness, 1.0).linear, 0.0);
  EXPECT_EQ(harness.reason(), "sonar: nothing received yet");
  harness.feed("sonar", sonar_of(infinity));
  EXPECT_EQ(checked(harness, 1.0).linear, 1.0);
  harness.feed("sonar", sonar_of(0.07F));
  EXPECT_EQ(checked(harness, 1.0).linear, 0.0);
  auto sonar = sonar_of(infinity);
  sonar.field_of_view = std::numeric_limits<float>::quiet_NaN();
  harness.feed("sonar", sonar);
  EXPECT_EQ(checked(harness, 1.0).linear, 0.0);
  EXPECT_EQ(harness.reason(), "sonar: its field of view is none");
}

TEST(CollisionMonitorComponent, StopsACommandThatIsNotFinite) {
  Harness harness("safety/collision_monitor");
  harness.feed("scan", scan_of(infinity));
  EXPECT_EQ(checked(harness, std::numeric_limits<double>::quiet_NaN()).linear, 0.0);
  EXPECT_EQ(harness.reason(), "cmd_vel_raw: stopped, the command is not finite");
}

}  // namespace
}  // namespace kervan::test
