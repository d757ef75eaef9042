/// The sensors of the component sim/world that a composition asks for: what they publish, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "framework/component/error.hpp"
#include "framework/test/harness.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/BumperState.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "kervan_msgs/msg/StallState.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "sensor_msgs/msg/Imu.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::TwistStamped;
using kervan_msgs::msg::BumperState;
using kervan_msgs::msg::SonarArray;
using kervan_msgs::msg::StallState;
using nav_msgs::msg::Odometry;
using sensor_msgs::msg::Imu;

ValueMap parameters(ValueMap robot, const std::string& model = "p3dx") {
  robot.emplace("model", KERVAN_SIM_FOLDER "/robots/" + model + ".yaml");
  return {{"map", KERVAN_SIM_FOLDER "/worlds/lab.yaml"}, {"robots", ValueMap{{"r1", robot}}}};
}

/// Commands the same speed at 20 Hz for `time`.
void drive(test::Harness& harness, double linear, double angular, Duration time) {
  TwistStamped message;
  message.twist.linear.x = linear;
  message.twist.angular.z = angular;
  for (Duration t{}; t < time; t += 50ms) {
    harness.feed("r1/cmd_vel", message);
    harness.advance(50ms);
  }
}

TEST(SensorsOfTheComponent, AreNotThereUnlessAskedFor) {
  test::Harness harness("sim/world", parameters({}));
  drive(harness, 0.5, 0.3, 1s);
  EXPECT_THROW(harness.latest<Imu>("r1/imu"), std::invalid_argument);
  EXPECT_THROW(harness.latest<BumperState>("r1/bumpers"), std::invalid_argument);
  EXPECT_THROW(harness.latest<StallState>("r1/stall"), std::invalid_argument);
}

TEST(SensorsOfTheComponent, SonarsThatFireInTurnSayNanWhenItIsNotTheirTurn) {
  test::Harness harness("sim/world", parameters({{"sonar_firing", std::string("sequential")}}));
  harness.advance(320ms);
  const auto rounds = harness.take<SonarArray>("r1/sonar");
  ASSERT_EQ(rounds.size(), 9u);
  for (std::size_t slot = 0; slot < 9; ++slot) {
    ASSERT_EQ(rounds[slot]->readings.size(), 16u);
    EXPECT_EQ(rounds[slot]->header.stamp.nanosec, slot * 40'000'000);
    for (std::size_t i = 0; i < 16; ++i) {
      EXPECT_EQ(std::isnan(rounds[slot]->readings[i].range), i % 8 != slot % 8) << "sonar " << i << ", slot " << slot;
      EXPECT_EQ(rounds[slot]->readings[i].x, rounds[0]->readings[i].x) << "each stays in its place of the list";
    }
  }
}

TEST(SensorsOfTheComponent, BumpersSayWhereTheyArePressed) {
  // The lab's wall is 1.5 m to the right; the robot looks at it.
  test::Harness harness(
      "sim/world", parameters({{"start", ValueList{0.0, 0.0, -1.5707963267948966}}, {"bumpers", std::string("both")}}));
  harness.advance(0ms);
  ASSERT_NE(harness.latest<BumperState>("r1/bumpers"), nullptr);
  EXPECT_FALSE(harness.latest<BumperState>("r1/bumpers")->pressed);
  harness.take<BumperState>("r1/bumpers");
  drive(harness, 0.5, 0.0, 5s);
  const auto states = harness.take<BumperState>("r1/bumpers");
  ASSERT_GE(states.size(), 1u);
  ASSERT_LE(states.size(), 3u) << "only when something changes";
  const BumperState& last = *states.back();
  EXPECT_EQ(last.header.frame_id, "r1/base_link");
  EXPECT_TRUE(last.pressed);
  ASSERT_EQ(last.segments.size(), 10u);
  EXPECT_TRUE(last.segments[2].pressed);
  EXPECT_FALSE(last.segments[7].pressed);
  EXPECT_FLOAT_EQ(last.segments[2].x, 0.26f);
  EXPECT_FLOAT_EQ(last.segments[2].yaw, 0.0f);
  EXPECT_FLOAT_EQ(last.segments[2].length, 0.105f);
  EXPECT_NEAR(harness.latest<Odometry>("r1/truth")->pose.pose.position.y, -1.5 + 0.26, 1e-4);
}

TEST(SensorsOfTheComponent, StallFlagsAreUpWhileTheRobotPushes) {
  test::Harness harness("sim/world",
                        parameters({{"start", ValueList{0.0, -1.0, -1.5707963267948966}}, {"stall_flags", true}}));
  harness.advance(0ms);
  EXPECT_FALSE(harness.latest<StallState>("r1/stall")->left);
  drive(harness, 0.5, 0.0, 4s);
  EXPECT_TRUE(harness.latest<StallState>("r1/stall")->left);
  EXPECT_TRUE(harness.latest<StallState>("r1/stall")->right);
  EXPECT_EQ(harness.latest<StallState>("r1/stall")->header.frame_id, "r1/base_link");
  drive(harness, 0.0, 0.0, 50ms);
  EXPECT_FALSE(harness.latest<StallState>("r1/stall")->left);
  EXPECT_FALSE(harness.latest<StallState>("r1/stall")->right);
}

TEST(SensorsOfTheComponent, TheGyroscopeIsAnImuWithNothingElse) {
  test::Harness harness("sim/world", parameters({{"gyro", true}, {"gyro_period", 0.1}, {"gyro_noise", 0.01}}));
  drive(harness, 0.0, 1.0, 2s);
  const auto readings = harness.take<Imu>("r1/imu");
  ASSERT_EQ(readings.size(), 21u);
  const Imu& last = *readings.back();
  EXPECT_EQ(last.header.frame_id, "r1/base_link");
  EXPECT_NEAR(last.angular_velocity.z, 1.0, 0.05);
  EXPECT_NE(last.angular_velocity.z, 1.0);
  EXPECT_NEAR(last.angular_velocity_covariance[8], 1e-4, 1e-15);
  EXPECT_EQ(last.orientation_covariance[0], -1.0) << "is not measured";
  EXPECT_EQ(last.linear_acceleration_covariance[0], -1.0) << "is not measured";
}

TEST(SensorsOfTheComponent, TheSonarsOfASynchroDriveTurnAgainstBaseLink) {
  test::Harness harness("sim/world", parameters({{"sonar_noise", 0.0}}, "k2a"));
  harness.advance(0ms);
  const SonarArray first = *harness.latest<SonarArray>("r1/sonar");
  ASSERT_EQ(first.readings.size(), 24u);
  EXPECT_FLOAT_EQ(first.readings[0].yaw, 0.0f);
  drive(harness, 0.0, 1.0, 1s);
  const SonarArray& later = *harness.latest<SonarArray>("r1/sonar");
  const auto& pose = harness.latest<Odometry>("r1/truth")->pose.pose;
  const double yaw = 2.0 * std::atan2(pose.orientation.z, pose.orientation.w);
  ASSERT_GT(yaw, 0.5);
  for (std::size_t i = 0; i < 24; ++i) {
    EXPECT_NEAR(std::remainder(later.readings[i].yaw - (first.readings[i].yaw - yaw), 2.0 * M_PI), 0.0, 1e-5);
    EXPECT_NEAR(std::hypot(later.readings[i].x, later.readings[i].y), 0.39, 1e-3);
    EXPECT_EQ(later.readings[i].range, first.readings[i].range) << "sonar " << i << " looks where it looked";
  }
}

TEST(SensorsOfTheComponent, TheErrorsOfTheModelAreThoseOfItsFile) {
  const auto end = [](ValueMap robot) {
    test::Harness harness("sim/world", parameters(std::move(robot)));
    drive(harness, 0.5, 0.2, 3s);
    return harness.latest<Odometry>("r1/odom")->pose.pose.position.x;
  };
  const double model = end({{"odometry_errors", std::string("model")}});
  EXPECT_NEAR(model, end({{"drift", 0.0075}, {"encoder_resolution", 7.8e-6}}), 2e-5);
  EXPECT_GT(std::abs(model - end({})), 2e-4);
}

std::string refusal(ValueMap robot, const std::string& model = "p3dx") {
  try {
    test::Harness harness("sim/world", parameters(std::move(robot), model));
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(SensorsOfTheComponent, WhatDoesNotFitTheModelIsRefused) {
  EXPECT_EQ(refusal({{"bumpers", std::string("rear")}}, "jackal"),
            "subject.robots.r1.bumpers: the model jackal has no rear bumpers");
  EXPECT_EQ(refusal({{"odometry_errors", std::string("model")}, {"wheel_slip", 0.01}}),
            "subject.robots.r1.odometry_errors: the errors are those of the model; leave out drift, wheel_error, "
            "wheel_slip and "
            "encoder_resolution, or set this to given");
  EXPECT_EQ(refusal({{"sonar_incidence_limit", 0.3}, {"sonar_incidence_drop_off", 0.4}}),
            "subject.robots.r1.sonar_incidence_drop_off: is more than sonar_incidence_limit");
  EXPECT_EQ(refusal({{"sonar_crosstalk", 1.5}}),
            "subject.robots.r1.sonar_crosstalk: 1.5 is out of range; allowed: 0 .. 1");
  EXPECT_EQ(refusal({{"bumpers", std::string("left")}}),
            "subject.robots.r1.bumpers: left is not one of none, front, rear, both");
}

}  // namespace
}  // namespace kervan::sim
