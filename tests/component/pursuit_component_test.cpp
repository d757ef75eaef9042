#include <gtest/gtest.h>

#include <limits>

#include "framework/test/harness.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::TwistStamped;

struct PursuitDrive {
  void feed(const geometry::Pose2& robot, const geometry::Twist2& moving = {}) {
    harness.feed("odom", odometry_at(robot, moving));
    harness.advance(100ms);
  }
  const geometry_msgs::msg::Twist& command() const { return harness.latest<TwistStamped>("cmd_vel_raw")->twist; }

  Harness harness{"control/pursuit"};
};

TEST(PursuitComponent, NeedsNoSensorOfObstacles) {
  PursuitDrive drive;
  drive.harness.feed("waypoint", pose_at(3.0, 0.0));
  drive.feed({});
  EXPECT_EQ(drive.command().linear.x, 0.6);
  EXPECT_EQ(drive.command().angular.z, 0.0);
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
}

TEST(PursuitComponent, StandsAndSaysWhatIsMissingOrWrong) {
  PursuitDrive drive;
  drive.harness.advance(0ms);
  drive.harness.advance(100ms);
  EXPECT_EQ(drive.harness.reason(), "waypoint: nothing received yet");
  drive.harness.feed("waypoint", pose_at(3.0, 0.0));
  drive.harness.advance(100ms);
  EXPECT_EQ(drive.harness.reason(), "odom: nothing received yet");
  drive.feed({}, {std::numeric_limits<double>::quiet_NaN(), 0.0});
  EXPECT_EQ(drive.harness.reason(), "odom: the speed is not finite");
  EXPECT_EQ(drive.harness.state(), ComponentState::degraded);
  EXPECT_EQ(drive.command().linear.x, 0.0);
  drive.feed({});
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
}

TEST(PursuitComponent, StandsStillAtItsWaypointUntilTheNextComes) {
  PursuitDrive drive;
  drive.harness.feed("waypoint", pose_at(3.0, 0.0));
  drive.feed({2.95, 0.0, 0.0});
  EXPECT_EQ(drive.command().linear.x, 0.0);
  drive.harness.feed("waypoint", pose_at(6.0, 0.0));
  drive.feed({2.95, 0.0, 0.0});
  EXPECT_EQ(drive.command().linear.x, 0.6);
  drive.harness.end();
  EXPECT_EQ(drive.command().linear.x, 0.0) << "its last word";
}

TEST(PursuitComponent, TurnsToATargetThatTeleportsInTheNextStep) {
  PursuitDrive drive;
  drive.harness.feed("waypoint", pose_at(3.0, 0.0));
  drive.feed({});
  EXPECT_EQ(drive.command().angular.z, 0.0);
  drive.harness.feed("waypoint", pose_at(-1000.0, 1.0));
  drive.feed({});
  EXPECT_GT(drive.command().angular.z, 0.0);
  EXPECT_LE(drive.command().linear.x, 0.6);
  EXPECT_GE(drive.command().linear.x, 0.0);
  drive.harness.feed("waypoint", pose_at(0.0, 0.0));
  drive.feed({});
  EXPECT_EQ(drive.command().linear.x, 0.0) << "it is there";
  EXPECT_EQ(drive.command().angular.z, 0.0);
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
}

}  // namespace
}  // namespace kervan::test
