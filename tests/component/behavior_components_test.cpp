// Each behaviour as a component: what triggers it, what it asks for, and where it ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "components/behavior/situation.hpp"
#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/ArbitrationState.hpp"
#include "kervan_msgs/msg/BumperState.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "kervan_msgs/msg/StallState.hpp"
#include "tests/component/plane_fixtures.hpp"
#include "tests/unit/components/p3dx_ring.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry::radians;
using geometry_msgs::msg::TwistStamped;
using kervan_msgs::msg::ArbitrationState;
using kervan_msgs::msg::MotionRequest;

kervan_msgs::msg::SonarArray sonar(Ranges ranges) {
  kervan_msgs::msg::SonarArray message;
  message.header.frame_id = "base_link";
  message.field_of_view = static_cast<float>(radians(30.0));
  message.min_range = 0.15F;
  message.max_range = 5.0F;
  for (const auto& reading : p3dx_ring(ranges)) {
    auto& sent = message.readings.emplace_back();
    sent.x = static_cast<float>(reading.transducer.x);
    sent.y = static_cast<float>(reading.transducer.y);
    sent.yaw = static_cast<float>(reading.transducer.yaw);
    sent.range = static_cast<float>(reading.range);
  }
  return message;
}

/// The robot stands at `pose` and hears `ranges`, for 100 ms.
void hear(Harness& harness, Ranges ranges, const geometry::Pose2& pose = {}, const geometry::Twist2& speed = {}) {
  harness.feed("sonar", sonar(ranges));
  harness.feed("odom", odometry_at(pose, speed));
  harness.advance(100ms);
}

const MotionRequest& asked(const Harness& harness) { return *harness.latest<MotionRequest>("motion_request"); }

/// The one segment of the robot, in the middle of its rear.
void press(Harness& harness, bool pressed) {
  kervan_msgs::msg::BumperState state;
  state.pressed = pressed;
  state.segments.resize(1);
  state.segments[0].x = -0.34F;
  state.segments[0].pressed = pressed;
  harness.feed("bumpers", state);
}

void stall(Harness& harness, bool left, bool right) {
  kervan_msgs::msg::StallState state;
  state.left = left;
  state.right = right;
  harness.feed("stall", state);
}

TEST(WallFollowComponent, FollowsAWallOnEitherSide) {
  Harness right("behavior/wall_follow");
  hear(right, {{7, 0.5}, {8, 0.5}});
  const MotionRequest& request = asked(right);
  EXPECT_EQ(request.behaviour, "wall_follow");
  EXPECT_EQ(request.priority, 20);
  EXPECT_TRUE(request.active);
  EXPECT_EQ(request.why, "a wall is beside the robot");
  EXPECT_EQ(request.twist.linear.x, 0.2);
  EXPECT_NEAR(request.twist.angular.z, -0.15, 1e-6);
  EXPECT_EQ(request.valid_for.nanosec, 150'000'000u);
  Harness left("behavior/wall_follow", {{"side", "left"}});
  hear(left, {{0, 0.5}, {15, 0.5}});
  EXPECT_NEAR(asked(left).twist.angular.z, 0.15, 1e-6);
  hear(left, {{7, 0.5}, {8, 0.5}});
  EXPECT_EQ(asked(left).why, "the wall beside the robot is remembered");
  for (int i = 0; i < 20; ++i) hear(left, {});
  EXPECT_FALSE(asked(left).active);
}

TEST(WallFindComponent, LooksAroundWhileNothingIsWithinAMetreOnTheRight) {
  Harness harness("behavior/wall_find");
  hear(harness, {{7, 0.9}});
  EXPECT_FALSE(asked(harness).active);
  hear(harness, {{3, 2.0}});
  EXPECT_TRUE(asked(harness).active);
  EXPECT_EQ(asked(harness).hold, 15);
  EXPECT_EQ(asked(harness).twist.linear.x, 0.0);
  EXPECT_EQ(asked(harness).twist.angular.z, 0.5);
  for (int degrees = 0; degrees <= 380; degrees += 5)
    hear(harness, {{3, 2.0}}, {0.0, 0.0, geometry::wrap_angle(radians(degrees))});
  EXPECT_EQ(asked(harness).why, "driving to the nearest wall");
  hear(harness, {{3, 0.39}}, {1.6, 0.0, 0.0});
  EXPECT_EQ(asked(harness).why, "turning the wall to the side");
  hear(harness, {{7, 0.42}, {8, 0.42}}, {1.6, 0.0, radians(90)});
  EXPECT_FALSE(asked(harness).active);
}

TEST(SideAvoidComponent, TurnsAwayFromTheNearSide) {
  Harness harness("behavior/side_avoid");
  hear(harness, {{0, 0.19}});
  EXPECT_TRUE(asked(harness).active);
  EXPECT_NEAR(asked(harness).twist.angular.z, -radians(50.0), 1e-9);
  hear(harness, {{7, 0.19}});
  EXPECT_NEAR(asked(harness).twist.angular.z, radians(50.0), 1e-9);
  hear(harness, {{0, 0.21}, {7, 0.21}});
  EXPECT_FALSE(asked(harness).active);
}

TEST(FrontAvoidComponent, TurnsBy90DegreesAwayFromTheWallsSide) {
  for (const char* side : {"right", "left"}) {
    const double sign = side == std::string("right") ? 1.0 : -1.0;
    Harness harness("behavior/front_avoid", {{"side", side}});
    hear(harness, {{3, 0.39}});
    EXPECT_TRUE(asked(harness).active);
    EXPECT_EQ(asked(harness).twist.angular.z, sign * 0.5);
    hear(harness, {}, {0.0, 0.0, sign * radians(80)});
    EXPECT_TRUE(asked(harness).active);
    hear(harness, {}, {0.0, 0.0, sign * radians(91)});
    EXPECT_FALSE(asked(harness).active);
  }
}

TEST(ConvexCornerComponent, GoesRoundTheEndOfTheWall) {
  Harness harness("behavior/convex_corner", {{"side", "left"}});
  hear(harness, {{0, 0.4}, {15, 0.4}});
  EXPECT_FALSE(asked(harness).active);
  hear(harness, {{15, 0.42}});
  EXPECT_TRUE(asked(harness).active);
  EXPECT_NEAR(asked(harness).twist.angular.z, 0.2 / 0.62, 1e-9) << "to the left, where the wall was";
  hear(harness, {{0, 0.5}}, {0.5, 0.5, radians(85)});
  EXPECT_FALSE(asked(harness).active);
}

TEST(BumperComponent, DrivesAwayFromTheSwitch) {
  Harness harness("behavior/bumper");
  press(harness, true);
  hear(harness, {});
  EXPECT_TRUE(asked(harness).active);
  EXPECT_EQ(asked(harness).twist.linear.x, 0.1);
  press(harness, false);
  hear(harness, {}, {0.1, 0.0, 0.0});
  EXPECT_TRUE(asked(harness).active);
  hear(harness, {}, {0.2, 0.0, 0.0});
  hear(harness, {}, {0.26, 0.0, 0.0});
  EXPECT_FALSE(asked(harness).active);
}

TEST(StallRecoverComponent, BacksUpAndTurnsToTheFreeSide) {
  Harness harness("behavior/stall_recover");
  hear(harness, {{7, 0.4}});
  EXPECT_FALSE(asked(harness).active);
  stall(harness, true, true);
  hear(harness, {{7, 0.4}});
  EXPECT_TRUE(asked(harness).active);
  EXPECT_EQ(asked(harness).priority, 70);
  EXPECT_EQ(asked(harness).twist.linear.x, -0.15);
  EXPECT_GT(asked(harness).twist.angular.z, 0.0);
  stall(harness, false, false);
  for (int i = 0; i < 51; ++i) hear(harness, {});
  EXPECT_FALSE(asked(harness).active);
}

TEST(Behaviours, TreatAContactAsAReadingFor15Seconds) {
  Harness harness("behavior/front_avoid");
  hear(harness, {}, {}, {0.2, 0.0});
  stall(harness, true, true);
  hear(harness, {}, {}, {0.2, 0.0});
  EXPECT_TRUE(asked(harness).active) << "something is at the nose that no sonar hears";
  stall(harness, false, false);
  for (int i = 0; i < 10; ++i) hear(harness, {}, {0.0, 0.0, radians(100)});
  EXPECT_FALSE(asked(harness).active);
  hear(harness, {}, {-0.1, 0.0, 0.0});
  EXPECT_TRUE(asked(harness).active) << "it is still there";
  for (int i = 0; i < 150; ++i) hear(harness, {}, {-0.1, 0.0, i < 140 ? 0.0 : radians(100)});
  hear(harness, {}, {-0.1, 0.0, 0.0});
  EXPECT_FALSE(asked(harness).active);
}

TEST(Behaviours, WantNothingWithoutFreshSonarsAndOdometry) {
  Harness harness("behavior/wall_follow");
  harness.advance(100ms);
  EXPECT_FALSE(asked(harness).active);
  EXPECT_EQ(harness.reason(), "sonar: nothing received yet");
  hear(harness, {{7, 0.4}});
  EXPECT_TRUE(asked(harness).active);
  EXPECT_EQ(harness.state(), ComponentState::active);
  harness.advance(500ms);
  EXPECT_FALSE(asked(harness).active);
  EXPECT_EQ(harness.reason(), "sonar: no sample for more than 0.50 s");
  auto nowhere = odometry_at({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  harness.feed("sonar", sonar({{7, 0.4}}));
  harness.feed("odom", nowhere);
  harness.advance(50ms);
  EXPECT_FALSE(asked(harness).active);
  EXPECT_EQ(harness.reason(), "odom: the pose is not finite");
}

TEST(Behaviours, WantNothingOnceTheOdometryIsTooOld) {
  Harness harness("behavior/wall_follow");
  hear(harness, {{7, 0.4}});
  for (int i = 0; i < 6; ++i) {
    harness.feed("sonar", sonar({{7, 0.4}}));
    harness.advance(100ms);
  }
  EXPECT_FALSE(asked(harness).active);
  EXPECT_EQ(harness.reason(), "odom: no sample for more than 0.50 s");
}

TEST(Behaviours, TakeRangesBeyondTheLargestAndThoseThatAreNotNumbersForNoEcho) {
  Harness harness("behavior/front_avoid");
  auto absurd = sonar({});
  absurd.readings[2].range = std::numeric_limits<float>::quiet_NaN();
  absurd.readings[3].range = 1e30F;
  absurd.readings[4].range = std::numeric_limits<float>::infinity();
  harness.feed("sonar", absurd);
  harness.feed("odom", odometry_at({}));
  harness.advance(100ms);
  EXPECT_FALSE(asked(harness).active);
  EXPECT_EQ(asked(harness).why, "the way ahead is free");
  EXPECT_EQ(harness.state(), ComponentState::active) << "sonars that do not fire and silence are nothing unusual";
}

TEST(Behaviours, WantNothingOfARingThatDoesNotFit) {
  Harness harness("behavior/wall_follow");
  auto half = sonar({{7, 0.4}});
  half.readings.resize(8);
  harness.feed("sonar", half);
  harness.feed("odom", odometry_at({}));
  harness.advance(100ms);
  EXPECT_FALSE(asked(harness).active);
  EXPECT_EQ(harness.reason(), "sonar: 8 readings, but the ring of a Pioneer has 16");
  auto turned = sonar({{7, 0.4}});
  turned.readings[5].yaw = static_cast<float>(radians(-50.0));
  harness.feed("sonar", turned);
  harness.advance(100ms);
  EXPECT_FALSE(asked(harness).active);
  EXPECT_EQ(harness.reason(), "sonar: transducer 5 does not look to -30 degrees, as that of a Pioneer does");
}

TEST(Behaviours, SayThatTheyLeaveNegativeRangesOut) {
  Harness harness("behavior/wall_follow");
  auto absurd = sonar({{7, 0.4}, {8, 0.4}});
  absurd.readings[3].range = -1.0F;
  harness.feed("sonar", absurd);
  harness.feed("odom", odometry_at({}));
  harness.advance(100ms);
  EXPECT_TRUE(asked(harness).active) << "the others are good";
  EXPECT_EQ(harness.reason(), "sonar: negative ranges are left out");
  hear(harness, {{7, 0.4}, {8, 0.4}});
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(Behaviours, RefuseAValidityShorterThanTheirPeriod) {
  try {
    Harness("behavior/wall_find", {{"period", 0.1}, {"valid_for", 0.1}});
    FAIL() << "it was taken";
  } catch (const ParameterError& error) {
    EXPECT_EQ(std::string(error.what()),
              "subject.valid_for: it is no longer than the period, so each request would be forgotten before the next");
  }
}

TEST(Behaviours, CommandByThemselvesUnderOwnershipWhileTheyWantToDrive) {
  Harness harness("behavior/wall_follow", {{"arbitration", "ownership"}, {"memory", 0.0}});
  hear(harness, {{7, 0.4}, {8, 0.4}});
  ASSERT_TRUE(harness.latest<TwistStamped>("cmd_vel_raw"));
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel_raw")->twist.linear.x, 0.2);
  harness.take<TwistStamped>("cmd_vel_raw");
  hear(harness, {});
  hear(harness, {});
  harness.take<TwistStamped>("cmd_vel_raw");
  hear(harness, {});
  EXPECT_TRUE(harness.take<TwistStamped>("cmd_vel_raw").empty()) << "whoever wants nothing leaves the topic to others";
}

TEST(Behaviours, SayAsTheirLastWordThatTheyWantNothing) {
  Harness harness("behavior/wall_follow");
  hear(harness, {{7, 0.4}, {8, 0.4}});
  harness.end();
  EXPECT_FALSE(asked(harness).active);
}

MotionRequest request(const std::string& behaviour, int priority, double speed) {
  MotionRequest message;
  message.behaviour = behaviour;
  message.header.frame_id = "base_link";
  message.priority = priority;
  message.active = true;
  message.valid_for.nanosec = 150'000'000;
  message.twist.linear.x = speed;
  message.why = "test";
  return message;
}

double speed(const Harness& harness) { return harness.latest<TwistStamped>("cmd_vel_raw")->twist.linear.x; }

TEST(ArbiterComponent, CommandsWhatTheStrongestWantsAndSaysWhoLost) {
  Harness harness("behavior/arbiter");
  for (int i = 0; i < 4; ++i) {
    harness.feed("motion_request", request("follow", 20, 0.2));
    harness.feed("motion_request", request("front", 50, 0.0));
    harness.feed("motion_request", request("bumper", 60, -0.1));
    harness.advance(50ms);
  }
  EXPECT_EQ(speed(harness), -0.1);
  const auto* state = harness.latest<ArbitrationState>("arbitration");
  EXPECT_EQ(state->behaviour, "bumper");
  EXPECT_EQ(state->priority, 60);
  EXPECT_EQ(state->why, "test");
  EXPECT_THAT(state->waiting, testing::ElementsAre("front", "follow"));
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(ArbiterComponent, MovesOnWithinTheDeadlineOfABehaviourThatDied) {
  Harness harness("behavior/arbiter");
  Time last{};
  for (int i = 0; i < 10; ++i) {
    harness.feed("motion_request", request("follow", 20, 0.2));
    harness.feed("motion_request", request("bumper", 60, -0.1));
    last = harness.now();
    harness.advance(50ms);
  }
  ASSERT_EQ(speed(harness), -0.1);
  harness.take<ArbitrationState>("arbitration");
  while (speed(harness) == -0.1) {
    ASSERT_LT(harness.now() - last, 150ms) << "its request is valid for so long";
    harness.feed("motion_request", request("follow", 20, 0.2));
    harness.advance(10ms);
  }
  EXPECT_EQ(speed(harness), 0.2);
  const auto* state = harness.latest<ArbitrationState>("arbitration");
  EXPECT_EQ(state->behaviour, "follow");
  EXPECT_THAT(state->expired, testing::ElementsAre("bumper"));
}

TEST(ArbiterComponent, CommandsZeroWithinTheDeadlineWhenTheLastBehaviourDied) {
  Harness harness("behavior/arbiter");
  for (int i = 0; i < 10; ++i) {
    harness.feed("motion_request", request("follow", 20, 0.2));
    harness.advance(50ms);
  }
  ASSERT_EQ(speed(harness), 0.2);
  harness.advance(100ms);
  EXPECT_EQ(speed(harness), 0.0);
  EXPECT_EQ(harness.reason(), "the robot stands: no behaviour says anything");
}

TEST(ArbiterComponent, RefusesWhatIsNotFiniteAndNamesWhoseItWas) {
  Harness harness("behavior/arbiter");
  harness.feed("motion_request", request("follow", 20, 0.2));
  harness.feed("motion_request", request("mad", 90, std::numeric_limits<double>::quiet_NaN()));
  harness.advance(100ms);
  EXPECT_EQ(speed(harness), 0.2);
  EXPECT_EQ(harness.reason(), "motion_request: refused one of 'mad' that cannot be");
}

TEST(ArbiterComponent, RefusesWhatIsValidForNoTimeAndWhatHasNoName) {
  Harness harness("behavior/arbiter");
  auto stillborn = request("follow", 20, 0.2);
  stillborn.valid_for.nanosec = 0;
  harness.feed("motion_request", stillborn);
  harness.advance(100ms);
  EXPECT_EQ(speed(harness), 0.0);
  EXPECT_EQ(harness.reason(), "motion_request: refused one of 'follow' that cannot be");
  Harness nameless("behavior/arbiter");
  nameless.feed("motion_request", request("", 20, 0.2));
  nameless.advance(100ms);
  EXPECT_EQ(speed(nameless), 0.0);
  EXPECT_EQ(nameless.reason(), "motion_request: refused one of '' that cannot be");
}

TEST(ArbiterComponent, CommandsZeroUnderOwnershipWhileTheBehavioursCommandByThemselves) {
  Harness harness("behavior/arbiter", {{"arbitration", "ownership"}});
  harness.feed("motion_request", request("follow", 20, 0.2));
  harness.advance(100ms);
  EXPECT_EQ(speed(harness), 0.0);
  EXPECT_EQ(harness.latest<ArbitrationState>("arbitration")->behaviour, "follow");
}

TEST(ArbiterComponent, SaysAZeroCommandAsItsLastWord) {
  Harness harness("behavior/arbiter");
  harness.feed("motion_request", request("follow", 20, 0.2));
  harness.advance(100ms);
  ASSERT_EQ(speed(harness), 0.2);
  harness.end();
  EXPECT_EQ(speed(harness), 0.0);
}

}  // namespace
}  // namespace kervan::test
