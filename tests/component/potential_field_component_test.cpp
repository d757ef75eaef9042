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

kervan_msgs::msg::SonarArray sonar_ahead(double range) {
  kervan_msgs::msg::SonarArray sonar;
  sonar.header.frame_id = "base_link";
  sonar.max_range = 5.0F;
  sonar.readings.resize(1);
  sonar.readings[0].x = 0.2F;
  sonar.readings[0].range = static_cast<float>(range);
  return sonar;
}

struct Drive {
  explicit Drive(const ValueMap& parameters = {}) : harness("control/potential_field", parameters) {}

  void feed(const geometry::Pose2& robot, double range) {
    harness.feed("odom", odometry_at(robot));
    harness.feed("sonar", sonar_ahead(range));
    harness.advance(100ms);
  }
  const geometry_msgs::msg::Twist& command() const { return harness.latest<TwistStamped>("cmd_vel_raw")->twist; }

  Harness harness;
};

constexpr double no_echo = std::numeric_limits<double>::infinity();

TEST(PotentialFieldComponent, DrivesStraightAtAWaypointAhead) {
  Drive drive;
  drive.harness.feed("waypoint", pose_at(3.0, 0.0));
  drive.feed({0.0, 0.0, 0.0}, no_echo);
  EXPECT_EQ(drive.command().linear.x, 0.5);
  EXPECT_EQ(drive.command().angular.z, 0.0);
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
  EXPECT_EQ(drive.harness.latest<TwistStamped>("cmd_vel_raw")->header.frame_id, "base_link");
}

TEST(PotentialFieldComponent, CommandsTenTimesASecond) {
  Drive drive;
  drive.harness.feed("waypoint", pose_at(3.0, 0.0));
  drive.feed({0.0, 0.0, 0.0}, no_echo);
  drive.harness.take<TwistStamped>("cmd_vel_raw");
  for (int i = 0; i < 10; ++i) drive.feed({0.0, 0.0, 0.0}, no_echo);
  EXPECT_EQ(drive.harness.take<TwistStamped>("cmd_vel_raw").size(), 10u);
}

TEST(PotentialFieldComponent, ShowsTheForcesInTheFrameOfTheOdometry) {
  Drive drive;
  drive.harness.feed("waypoint", pose_at(0.0, 1.0));
  drive.feed({0.0, 0.0, geometry::radians(90.0)}, 0.3);  // the obstacle is 0.5 m to the north, like the waypoint
  const auto* force = drive.harness.latest<kervan_msgs::msg::ForceField>("force");
  ASSERT_TRUE(force);
  EXPECT_EQ(force->header.frame_id, "odom");
  EXPECT_NEAR(force->attraction.y, 1.0, 1e-6);
  EXPECT_NEAR(force->repulsion.y, 0.45 - 1.2, 1e-6);
}

TEST(PotentialFieldComponent, KeepsTheObstacleWhereItWasHeard) {
  Drive drive;
  drive.harness.feed("waypoint", pose_at(0.0, 0.9));
  drive.feed({0.0, 0.0, 0.0}, 0.4);  // the obstacle is at (0.6, 0)
  drive.harness.feed("odom", odometry_at({0.0, 0.1, 0.0}));
  drive.harness.advance(100ms);
  const auto* force = drive.harness.latest<kervan_msgs::msg::ForceField>("force");
  ASSERT_TRUE(force);
  EXPECT_LT(force->repulsion.x, 0.0);
  const double rho = std::hypot(0.6, 0.1), f1 = 0.3 * (1.0 / rho - 1.0) * std::pow(0.8, 3) / (rho * rho);
  EXPECT_NEAR(force->repulsion.x, -f1 * 0.6 / rho, 1e-6);
}

TEST(PotentialFieldComponent, StandsAndSaysWhichInputIsMissing) {
  Drive drive;
  drive.harness.advance(0ms);
  EXPECT_EQ(drive.command().linear.x, 0.0);
  EXPECT_EQ(drive.harness.state(), ComponentState::active) << "nobody can have published yet";
  drive.harness.advance(100ms);
  EXPECT_EQ(drive.harness.state(), ComponentState::degraded);
  EXPECT_EQ(drive.harness.reason(), "waypoint: nothing received yet");
  drive.harness.feed("waypoint", pose_at(3.0, 0.0));
  drive.harness.advance(100ms);
  EXPECT_EQ(drive.harness.reason(), "odom: nothing received yet");
  drive.harness.feed("odom", odometry_at({}));
  drive.harness.advance(100ms);
  EXPECT_EQ(drive.harness.reason(), "sonar: nothing received yet");
  drive.feed({}, no_echo);
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
}

TEST(PotentialFieldComponent, ASonarThatDidNotFireCountsWithWhatItHeardLast) {
  // In turn, one says that 0.5 m ahead something stands, and the other hears nothing to the side.
  const auto hear = [](Drive& drive, double x, double ahead, double aside) {
    kervan_msgs::msg::SonarArray sonar = sonar_ahead(ahead);
    sonar.readings.resize(2);
    sonar.readings[1].yaw = 1.5F;
    sonar.readings[1].range = static_cast<float>(aside);
    drive.harness.feed("odom", odometry_at({x, 0.0, 0.0}));
    drive.harness.feed("sonar", sonar);
    drive.harness.advance(100ms);
    return drive.harness.latest<kervan_msgs::msg::ForceField>("force")->repulsion.x;
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Drive together, in_turn;
  for (Drive* drive : {&together, &in_turn}) drive->harness.feed("waypoint", pose_at(9.0, 0.0));
  EXPECT_EQ(hear(in_turn, 0.0, 0.5, nan), hear(together, 0.0, 0.5, no_echo));
  EXPECT_LT(hear(in_turn, 0.0, nan, no_echo), 0.0) << "it still stands there";
  // 0.1 m on it is as much nearer, though nobody has heard it again.
  EXPECT_NEAR(hear(in_turn, 0.1, nan, no_echo), hear(together, 0.1, 0.4, no_echo), 1e-5);
  EXPECT_EQ(hear(in_turn, 0.1, no_echo, nan), 0.0) << "now it has gone";
}

TEST(PotentialFieldComponent, StandsWhenTheSonarStops) {
  Drive drive;
  drive.harness.feed("waypoint", pose_at(9.0, 0.0));
  drive.feed({0.0, 0.0, 0.0}, no_echo);
  EXPECT_GT(drive.command().linear.x, 0.0);
  for (int i = 0; i < 7; ++i) {
    drive.harness.feed("odom", odometry_at({}));
    drive.harness.advance(100ms);
  }
  EXPECT_EQ(drive.command().linear.x, 0.0);
  EXPECT_EQ(drive.harness.state(), ComponentState::degraded);
  EXPECT_TRUE(drive.harness.reason().starts_with("sonar: ")) << drive.harness.reason();
}

TEST(PotentialFieldComponent, StandsWhenThePoseIsNotFinite) {
  Drive drive;
  drive.harness.feed("waypoint", pose_at(9.0, 0.0));
  drive.feed({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, no_echo);
  EXPECT_EQ(drive.command().linear.x, 0.0);
  EXPECT_EQ(drive.harness.reason(), "odom: the pose is not finite");
}

TEST(PotentialFieldComponent, StandsStillAtItsWaypointUntilTheNextComes) {
  Drive drive;
  drive.harness.feed("waypoint", pose_at(3.0, 0.0));
  drive.feed({2.98, 0.0, 0.0}, no_echo);
  EXPECT_EQ(drive.command().linear.x, 0.0);
  drive.feed({2.90, 0.0, 0.0}, no_echo);
  EXPECT_EQ(drive.command().linear.x, 0.0) << "pushed away, it does not come back by itself";
  drive.harness.feed("waypoint", pose_at(6.0, 0.0));
  drive.feed({2.90, 0.0, 0.0}, no_echo);
  EXPECT_EQ(drive.command().linear.x, 0.5);
}

TEST(PotentialFieldComponent, TurnsAwayFromAWallBehindTheGoalOnlyWithTheClassicalLaw) {
  Drive classical(ValueMap{{"law", "potential_classic"}}), ge_cui(ValueMap{{"law", "potential_gecui"}});
  for (Drive* drive : {&classical, &ge_cui}) {
    drive->harness.feed("waypoint", pose_at(0.2, 0.0));
    drive->feed({0.0, 0.0, 0.0}, 0.4);  // 0.6 m from the wall, 0.2 m from the goal
  }
  EXPECT_EQ(classical.command().linear.x, 0.0);
  EXPECT_GT(ge_cui.command().linear.x, 0.05);
}

TEST(PotentialFieldComponent, SaysAZeroCommandAsItsLastWord) {
  Drive drive;
  drive.harness.feed("waypoint", pose_at(3.0, 0.0));
  drive.feed({0.0, 0.0, 0.0}, no_echo);
  drive.harness.end();
  EXPECT_EQ(drive.command().linear.x, 0.0);
}

}  // namespace
}  // namespace kervan::test
