/// The component sim/world by itself: commands in, sensors out, on logical time.
#include <gtest/gtest.h>

#include <cmath>

#include "framework/component/error.hpp"
#include "framework/test/harness.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/Contact.hpp"
#include "kervan_msgs/msg/Outline.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "rosgraph_msgs/msg/Clock.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "sensor_msgs/msg/Range.hpp"
#include "tf2_msgs/msg/TFMessage.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::TwistStamped;
using kervan_msgs::msg::Contact;
using kervan_msgs::msg::SonarArray;
using nav_msgs::msg::Odometry;

ValueMap parameters(ValueMap robot = {}, const std::string& model = "p3dx") {
  robot.emplace("model", KERVAN_SIM_FOLDER "/robots/" + model + ".yaml");
  return {{"map", KERVAN_SIM_FOLDER "/worlds/lab.yaml"}, {"robots", ValueMap{{"r1", robot}}}};
}

TwistStamped twist(double linear, double angular) {
  TwistStamped message;
  message.twist.linear.x = linear;
  message.twist.angular.z = angular;
  return message;
}

/// Commands the same speed at 20 Hz for `time`.
void drive(test::Harness& harness, const TwistStamped& wanted, Duration time) {
  for (Duration t{}; t < time; t += 50ms) {
    harness.feed("r1/cmd_vel", wanted);
    harness.advance(50ms);
  }
}

TEST(SimulatorComponent, MeasuresAtTheStart) {
  test::Harness harness("sim/world", parameters());
  harness.advance(0ms);
  const auto* sonar = harness.latest<SonarArray>("r1/sonar");
  ASSERT_NE(sonar, nullptr);
  EXPECT_EQ(sonar->header.frame_id, "r1/base_link");
  ASSERT_EQ(sonar->readings.size(), 16u);
  EXPECT_FLOAT_EQ(sonar->readings[7].y, -0.136f);
  EXPECT_NEAR(sonar->readings[7].range, 1.5 - 0.136, 0.06);
  EXPECT_TRUE(std::isinf(sonar->readings[3].range));
  ASSERT_NE(harness.latest<Odometry>("r1/odom"), nullptr);
  EXPECT_EQ(harness.latest<Odometry>("r1/odom")->header.frame_id, "r1/odom");
  EXPECT_EQ(harness.latest<Odometry>("r1/odom")->child_frame_id, "r1/base_link");
  ASSERT_NE(harness.latest<Odometry>("r1/truth"), nullptr);
  EXPECT_EQ(harness.latest<Odometry>("r1/truth")->header.frame_id, "map");
}

TEST(SimulatorComponent, PublishesEverythingAtItsOwnRate) {
  test::Harness harness("sim/world", parameters());
  harness.advance(1s);
  EXPECT_EQ(harness.take<SonarArray>("r1/sonar").size(), 11u);
  EXPECT_EQ(harness.take<Odometry>("r1/odom").size(), 21u);
  EXPECT_EQ(harness.take<Odometry>("r1/truth").size(), 101u);
  const auto clock = harness.take<rosgraph_msgs::msg::Clock>("/clock");
  EXPECT_EQ(clock.size(), 101u);
  EXPECT_EQ(clock.back()->clock.sec, 1);
  EXPECT_EQ(clock.back()->clock.nanosec, 0u);
  const auto frames = harness.take<tf2_msgs::msg::TFMessage>("/tf");
  EXPECT_EQ(frames.size(), 21u);
  ASSERT_EQ(frames.back()->transforms.size(), 2u);
  EXPECT_EQ(frames.back()->transforms[0].header.frame_id, "map");
  EXPECT_EQ(frames.back()->transforms[1].header.frame_id, "r1/odom");
  EXPECT_EQ(frames.back()->transforms[1].child_frame_id, "r1/base_link");
}

TEST(SimulatorComponent, PublishesTheScansOfALaserInItsOwnFrame) {
  ValueMap values = parameters({{"laser_noise", 0.0}, {"laser_period", 0.2}}, "p3at");
  test::Harness harness("sim/world", values);
  harness.advance(1s);
  const auto scans = harness.take<sensor_msgs::msg::LaserScan>("r1/scan");
  ASSERT_EQ(scans.size(), 6u);
  const auto& scan = *scans.back();
  EXPECT_EQ(scan.header.frame_id, "r1/laser");
  EXPECT_EQ(scan.header.stamp.sec, 1);
  ASSERT_EQ(scan.ranges.size(), 181u);
  EXPECT_FLOAT_EQ(scan.angle_min + 180.0f * scan.angle_increment, scan.angle_max);
  EXPECT_FLOAT_EQ(scan.scan_time, 0.2f);
  EXPECT_NEAR(scan.ranges[0], 1.5, 1e-6) << "the wall to the right";
  EXPECT_NEAR(scan.ranges[180], 17.5, 1e-6) << "the wall to the left";
  const auto* frames = harness.latest<tf2_msgs::msg::TFMessage>("/tf");
  ASSERT_EQ(frames->transforms.size(), 3u);
  EXPECT_EQ(frames->transforms[2].header.frame_id, "r1/base_link");
  EXPECT_EQ(frames->transforms[2].child_frame_id, "r1/laser");
  EXPECT_EQ(frames->transforms[2].transform.translation.x, 0.125);
}

TEST(SimulatorComponent, DrivesAsCommandedAndBrakesWhenTheCommandsEnd) {
  test::Harness harness("sim/world", parameters());
  drive(harness, twist(0.3, 0.0), 2s);
  EXPECT_NEAR(harness.latest<Odometry>("r1/truth")->twist.twist.linear.x, 0.3, 1e-9);
  const auto truth = harness.latest<Odometry>("r1/truth")->pose.pose.position;
  EXPECT_NEAR(truth.x, 0.3 * 2.0 - 0.15, 1e-6);
  EXPECT_NEAR(harness.latest<Odometry>("r1/odom")->pose.pose.position.x, truth.x, 1e-9) << "no drift was asked for";
  // The last command came 50 ms ago.
  harness.advance(200ms);
  EXPECT_NEAR(harness.latest<Odometry>("r1/truth")->twist.twist.linear.x, 0.3, 1e-9);
  harness.advance(10ms);
  EXPECT_NEAR(harness.latest<Odometry>("r1/truth")->twist.twist.linear.x, 0.3 - 0.006, 1e-9);
  harness.advance(500ms);
  EXPECT_EQ(harness.latest<Odometry>("r1/truth")->twist.twist.linear.x, 0.0);
}

TEST(SimulatorComponent, ReportsAContactOnceWithItsPlace) {
  test::Harness harness("sim/world", parameters({{"start", ValueList{0.0, -1.0, -1.5707963267948966}}}));
  drive(harness, twist(0.5, 0.0), 3s);
  const auto contacts = harness.take<Contact>("r1/contact");
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts[0]->robot, "r1");
  EXPECT_EQ(contacts[0]->count, 1u);
  EXPECT_NEAR(contacts[0]->point.y, -1.5, 1e-9);
  EXPECT_NEAR(harness.latest<sensor_msgs::msg::Range>("r1/clearance")->range, 0.0, 1e-5);
  EXPECT_NEAR(harness.latest<Odometry>("r1/truth")->pose.pose.position.y, -1.5 + 0.211, 1e-5);
}

TEST(SimulatorComponent, SaysSoWhenACommandIsNotFinite) {
  test::Harness harness("sim/world", parameters());
  harness.feed("r1/cmd_vel", twist(std::nan(""), 0.0));
  harness.advance(20ms);
  EXPECT_EQ(harness.state(), ComponentState::degraded);
  EXPECT_EQ(harness.reason(), "r1/cmd_vel: refused a command that is not finite");
  harness.feed("r1/cmd_vel", twist(0.1, 0.0));
  harness.advance(20ms);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(SimulatorComponent, ShowsTheWorldToWhoeverDrawsIt) {
  test::Harness harness("sim/world", parameters());
  harness.advance(0ms);
  const auto* outline = harness.latest<kervan_msgs::msg::Outline>("outline");
  ASSERT_NE(outline, nullptr);
  EXPECT_EQ(outline->segments.size(), 5u);
  ASSERT_EQ(outline->circles.size(), 1u);
  EXPECT_EQ(outline->circles[0].radius, 0.30);
}

TEST(SimulatorComponent, TheSameSeedGivesTheSameTrace) {
  const auto hash = [](std::int64_t seed) {
    ValueMap values = parameters({{"drift", 0.03}});
    values["seed"] = seed;
    test::Harness harness("sim/world", values);
    drive(harness, twist(0.5, 0.2), 2s);
    return harness.trace_hash();
  };
  EXPECT_EQ(hash(1), hash(1));
  EXPECT_NE(hash(1), hash(2));
}

TEST(SimulatorComponent, RefusesARobotInsideAnObstacle) {
  try {
    test::Harness harness("sim/world", parameters({{"start", ValueList{8.2, 6.6, 0.0}}}));
    FAIL() << "nothing was refused";
  } catch (const ParameterError& error) {
    EXPECT_TRUE(error.parameter().ends_with("robots.r1.start")) << error.parameter();
    EXPECT_EQ(error.message(), "the robot would stand in an obstacle of lab");
  }
}

}  // namespace
}  // namespace kervan::sim
