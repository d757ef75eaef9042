#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/ForceField.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::TwistStamped;

constexpr double no_echo = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// One sonar, 0.4 m from the middle of the robot, that looks to `yaw`.
kervan_msgs::msg::SonarArray sonar_at(double yaw, double range) {
  kervan_msgs::msg::SonarArray sonar;
  sonar.header.frame_id = "base_link";
  sonar.min_range = 0.15F;
  sonar.max_range = 5.0F;
  sonar.readings.resize(1);
  sonar.readings[0].x = static_cast<float>(0.4 * std::cos(yaw));
  sonar.readings[0].y = static_cast<float>(0.4 * std::sin(yaw));
  sonar.readings[0].yaw = static_cast<float>(yaw);
  sonar.readings[0].range = static_cast<float>(range);
  return sonar;
}

struct VffDrive {
  explicit VffDrive(const ValueMap& parameters = {}) : harness("control/vff", parameters) {
    harness.feed("waypoint", pose_at(9.0, 0.0));
  }

  void feed(const kervan_msgs::msg::SonarArray& sonar, const geometry::Pose2& robot = {}, double speed = 0.5) {
    harness.feed("odom", odometry_at(robot, {speed, 0.0}));
    harness.feed("sonar", sonar);
    harness.advance(100ms);
  }
  void feed(double yaw, double range) { feed(sonar_at(yaw, range)); }
  const geometry_msgs::msg::Twist& command() const { return harness.latest<TwistStamped>("cmd_vel_raw")->twist; }
  const kervan_msgs::msg::ForceField& force() const { return *harness.latest<kervan_msgs::msg::ForceField>("force"); }

  Harness harness;
};

TEST(VffComponent, DrivesStraightAtAWaypointAhead) {
  VffDrive drive;
  drive.feed(0.0, no_echo);
  EXPECT_EQ(drive.command().linear.x, 0.78);
  EXPECT_EQ(drive.command().angular.z, 0.0);
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
  EXPECT_EQ(drive.force().header.frame_id, "odom");
}

TEST(VffComponent, TurnsAwayFromWhatItsSonarsHear) {
  for (const double side : {0.6, -0.6}) {
    VffDrive drive;
    for (int i = 0; i < 5; ++i) drive.feed(side, 0.5);
    EXPECT_LT(drive.command().angular.z * side, 0.0);
    EXPECT_LT(drive.command().linear.x, 0.78);
    EXPECT_GE(drive.command().linear.x, 0.2);
  }
}

TEST(VffComponent, GrowsSurerWithEachEchoFromACell) {
  VffDrive drive;
  drive.feed(1.5707, 0.65);  // into the cell from y = 1.0 on
  const double once = drive.force().repulsion.y;
  EXPECT_LT(once, 0.0);
  drive.feed(1.5707, 0.65);
  EXPECT_NEAR(drive.force().repulsion.y, 2.0 * once, 1e-6);
  for (int i = 0; i < 10; ++i) drive.feed(1.5707, 0.65);
  EXPECT_NEAR(drive.force().repulsion.y, 5.0 * once, 1e-6) << "15 is the most";
}

TEST(VffComponent, AnEchoFromFartherAwayLowersWhatLiesBefore) {
  VffDrive drive;
  drive.feed(0.3, 0.65);
  const double once = std::hypot(drive.force().repulsion.x, drive.force().repulsion.y);
  for (int i = 0; i < 3; ++i) drive.feed(0.3, no_echo);
  EXPECT_GT(once, 0.0);
  EXPECT_EQ(drive.force().repulsion.x, 0.0);
}

TEST(VffComponent, RemembersWhatItNoLongerHears) {
  VffDrive drive;
  drive.feed(1.0, 0.5);
  const double heard = drive.force().repulsion.y;
  drive.feed(1.0, nan);
  EXPECT_EQ(drive.force().repulsion.y, heard) << "a sonar that did not fire says nothing";
}

TEST(VffComponent, StandsAndSaysWhichInputIsMissing) {
  Harness harness("control/vff");
  harness.advance(0ms);
  harness.advance(100ms);
  EXPECT_EQ(harness.reason(), "waypoint: nothing received yet");
  harness.feed("waypoint", pose_at(3.0, 0.0));
  harness.advance(100ms);
  EXPECT_EQ(harness.reason(), "odom: nothing received yet");
  harness.feed("odom", odometry_at({}));
  harness.advance(100ms);
  EXPECT_EQ(harness.reason(), "sonar: nothing received yet");
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel_raw")->twist.linear.x, 0.0);
}

TEST(VffComponent, StandsWhenTheSonarStops) {
  VffDrive drive;
  drive.feed(0.0, no_echo);
  EXPECT_GT(drive.command().linear.x, 0.0);
  for (int i = 0; i < 7; ++i) {
    drive.harness.feed("odom", odometry_at({}));
    drive.harness.advance(100ms);
  }
  EXPECT_EQ(drive.command().linear.x, 0.0);
  EXPECT_EQ(drive.harness.state(), ComponentState::degraded);
  EXPECT_TRUE(drive.harness.reason().starts_with("sonar: ")) << drive.harness.reason();
}

TEST(VffComponent, StandsAndSaysWhatIsWrongWithAnInput) {
  const auto stands = [](VffDrive& drive, const char* why) {
    EXPECT_EQ(drive.command().linear.x, 0.0) << why;
    EXPECT_EQ(drive.command().angular.z, 0.0) << why;
    EXPECT_EQ(drive.harness.state(), ComponentState::degraded) << why;
    EXPECT_EQ(drive.harness.reason(), why);
  };
  VffDrive drive;
  drive.feed(0.0, no_echo);
  drive.feed(sonar_at(0.0, no_echo), {nan, 0.0, 0.0});
  stands(drive, "odom: the pose is not finite");
  drive.feed(sonar_at(0.0, no_echo), {}, nan);
  stands(drive, "odom: the speed is not finite");
  drive.feed(sonar_at(0.0, no_echo), {2e6, 0.0, 0.0});
  stands(drive, "odom: the robot is too far away from its origin");
  kervan_msgs::msg::SonarArray inverted = sonar_at(0.0, no_echo);
  inverted.max_range = 0.1F;
  drive.feed(inverted);
  stands(drive, "sonar: its ranges are none");
  drive.feed(0.0, no_echo);
  drive.feed(0.0, no_echo);
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
  drive.harness.feed("waypoint", pose_at(nan, 0.0));
  drive.feed(0.0, no_echo);
  stands(drive, "waypoint: the position is not finite");
}

TEST(VffComponent, LeavesOutReadingsThatCannotBeAndSaysSo) {
  VffDrive drive;
  drive.feed(0.0, no_echo);
  drive.feed(0.0, -1.0);
  EXPECT_EQ(drive.harness.reason(), "sonar: ranges that are no distance are left out");
  EXPECT_EQ(drive.command().linear.x, 0.78) << "the others may be right";
  drive.feed(nan, 1.0);
  EXPECT_EQ(drive.harness.reason(), "sonar: readings from nowhere are left out");
  drive.feed(0.0, no_echo);
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
}

TEST(VffComponent, StandsWhereItsGridMayNotGrow) {
  VffDrive drive({{"memory", 0.1}});
  drive.feed(0.0, no_echo);
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
  drive.feed(sonar_at(0.0, no_echo), {1000.0, 0.0, 0.0});
  EXPECT_EQ(drive.command().linear.x, 0.0);
  EXPECT_EQ(drive.harness.reason(), "sonar: the certainty grid has no memory for what it hears here");
}

TEST(VffComponent, StandsStillAtItsWaypointUntilTheNextComes) {
  VffDrive drive;
  drive.feed(sonar_at(0.0, no_echo), {8.8, 0.0, 0.0});
  EXPECT_EQ(drive.command().linear.x, 0.0);
  drive.harness.feed("waypoint", pose_at(12.0, 0.0));
  drive.feed(sonar_at(0.0, no_echo), {8.8, 0.0, 0.0});
  EXPECT_EQ(drive.command().linear.x, 0.78);
}

TEST(VffComponent, SaysAZeroCommandAsItsLastWord) {
  VffDrive drive;
  drive.feed(0.0, no_echo);
  drive.harness.end();
  EXPECT_EQ(drive.command().linear.x, 0.0);
}

}  // namespace
}  // namespace kervan::test
