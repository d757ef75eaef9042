#include <gtest/gtest.h>

#include <limits>

#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "tests/component/map_fixtures.hpp"
#include "tf2_msgs/msg/TFMessage.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry::Pose2;
using kervan_msgs::msg::SonarArray;
using nav_msgs::msg::Odometry;
using sensor_msgs::msg::LaserScan;

/// The distance from a place within 4 m x 3 m, the origin in the middle, to its walls.
float to_wall(const Pose2& from) {
  const geometry::Vector2 d = geometry::heading(from.yaw);
  const double x = d.x() > 0.0 ? (2.0 - from.x) / d.x() : (-2.0 - from.x) / d.x();
  const double y = d.y() > 0.0 ? (1.5 - from.y) / d.y() : (-1.5 - from.y) / d.y();
  return static_cast<float>(std::min(std::abs(x), std::abs(y)));
}

LaserScan scan_at(Time stamp, const Pose2& laser) {
  LaserScan scan;
  scan.header.stamp = geometry::to_message(stamp);
  scan.angle_min = -1.5707963f;
  scan.angle_max = 1.5707963f;
  scan.angle_increment = 0.01745329f;
  scan.range_min = 0.05f;
  scan.range_max = 8.0f;
  for (int i = 0; i < 181; ++i) scan.ranges.push_back(to_wall(laser * Pose2{0.0, 0.0, geometry::radians(i - 90.0)}));
  return scan;
}

SonarArray sonar_at(Time stamp, const Pose2& robot) {
  SonarArray array;
  array.header.stamp = geometry::to_message(stamp);
  array.field_of_view = 0.5235988f;
  array.min_range = 0.15f;
  array.max_range = 5.0f;
  for (int i = 0; i < 16; ++i) {
    const Pose2 transducer = Pose2{0.0, 0.0, geometry::radians(22.5 * i)} * Pose2{0.2, 0.0, 0.0};
    auto& reading = array.readings.emplace_back();
    reading.x = static_cast<float>(transducer.x);
    reading.y = static_cast<float>(transducer.y);
    reading.yaw = static_cast<float>(transducer.yaw);
    reading.range = 100.0f;
    for (int k = -7; k <= 7; ++k)
      reading.range =
          std::min(reading.range, to_wall(robot * transducer * Pose2{0.0, 0.0, geometry::radians(2.0 * k)}));
  }
  return array;
}

/// To and fro on a circle, with wheels that turn 5 % too far; every sample 50 ms after the last one.
struct Drive {
  Pose2 truth{0.6, 0.0, 1.5707963}, odom = truth;

  void step() {
    truth = truth * Pose2{0.03, 0.0, 0.05};
    odom = odom * Pose2{0.03, 0.0, 0.0525};
  }
  double error_of(const Pose2& pose) const { return (pose.position() - truth.position()).norm(); }
};

Odometry robot_odometry(Time stamp, const Pose2& pose) {
  Odometry odom = odometry_at(stamp, pose);
  odom.header.frame_id = "r1/odom";
  odom.child_frame_id = "r1/base_link";
  odom.twist.twist.linear.x = 0.25;
  return odom;
}

TEST(OdometryComponent, SaysWhereTheRobotIsInTheMap) {
  Harness harness("localization/odometry", {{"start", ValueList{10.0, 0.0, 1.5707963267948966}}});
  harness.feed("odom", robot_odometry(harness.now(), {1.0, 0.5, 0.0}));
  harness.advance(20ms);
  const Odometry* pose = harness.latest<Odometry>("pose");
  ASSERT_NE(pose, nullptr);
  EXPECT_EQ(pose->header.frame_id, "map");
  EXPECT_EQ(pose->child_frame_id, "r1/base_link");
  EXPECT_EQ(pose->twist.twist.linear.x, 0.25);
  EXPECT_NEAR(pose->pose.pose.position.x, 9.5, 1e-9);
  EXPECT_NEAR(pose->pose.pose.position.y, 1.0, 1e-9);
  const auto* tf = harness.latest<tf2_msgs::msg::TFMessage>("/tf");
  ASSERT_EQ(tf->transforms.size(), 1u);
  EXPECT_EQ(tf->transforms[0].header.frame_id, "map");
  EXPECT_EQ(tf->transforms[0].child_frame_id, "r1/odom");
  EXPECT_EQ(tf->transforms[0].transform.translation.x, 10.0);
}

TEST(OdometryComponent, SaysOnRequestWhereBaseLinkIsInOdom) {
  Harness harness("localization/odometry", {{"odom_to_base", true}});
  harness.feed("odom", robot_odometry(harness.now(), {1.0, 0.5, 0.0}));
  harness.advance(20ms);
  const auto* tf = harness.latest<tf2_msgs::msg::TFMessage>("/tf");
  ASSERT_EQ(tf->transforms.size(), 2u);
  EXPECT_EQ(tf->transforms[1].header.frame_id, "r1/odom");
  EXPECT_EQ(tf->transforms[1].child_frame_id, "r1/base_link");
  EXPECT_EQ(tf->transforms[1].transform.translation.y, 0.5);
}

TEST(OdometryComponent, GetsLessSureWithTheWay) {
  Harness harness("localization/odometry");
  double last = -1.0;
  for (int i = 0; i < 5; ++i) {
    harness.feed("odom", robot_odometry(harness.now(), {0.5 * i, 0.0, 0.0}));
    harness.advance(50ms);
    const double variance = harness.latest<Odometry>("pose")->pose.covariance[0];
    EXPECT_GT(variance, last);
    last = variance;
  }
}

TEST(OdometryComponent, LeavesOutPosesThatAreNoneAndSaysSo) {
  Harness harness("localization/odometry");
  harness.feed("odom", robot_odometry(harness.now(), {1.0, 0.0, 0.0}));
  harness.advance(50ms);
  harness.feed("odom", robot_odometry(harness.now(), {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}));
  harness.advance(450ms);
  EXPECT_EQ(harness.reason(), "odom: the pose is not finite");
  EXPECT_EQ(harness.take<Odometry>("pose").size(), 1u);
  harness.advance(1s);
  EXPECT_EQ(harness.reason(), "odom: no sample for more than 0.50 s");
}

TEST(OdometryComponent, SaysThatItsInputBeganAnew) {
  Harness harness("localization/odometry");
  harness.feed("odom", robot_odometry(harness.now(), {1.0, 0.0, 0.0}));
  harness.advance(50ms);
  harness.feed("odom", robot_odometry(harness.now(), {50.0, 0.0, 0.0}));
  harness.advance(450ms);
  EXPECT_EQ(harness.reason(), "odom: began anew; the robot is taken to have stood still");
  EXPECT_NEAR(harness.latest<Odometry>("pose")->pose.pose.position.x, 1.0, 1e-9);
}

/// Where it believes to be after `samples`; the scan of each is fed with its odometry.
Pose2 drive_by_laser(Harness& harness, Drive& drive, int samples, const Pose2& mount = {}) {
  for (int i = 0; i < samples; ++i) {
    harness.feed("scan", scan_at(harness.now(), drive.truth * mount));
    harness.feed("odom", robot_odometry(harness.now(), drive.odom));
    harness.advance(50ms);
    if (i + 1 < samples) drive.step();
  }
  return geometry::pose_of(harness.latest<Odometry>("pose")->pose.pose);
}

TEST(ScanMatchComponent, IsNearerToTheTruthThanTheWheels) {
  Harness harness("localization/scan_match", {{"mount", ValueList{0.1, 0.0, 0.0}}});
  Drive drive;
  const Pose2 pose = drive_by_laser(harness, drive, 400, {0.1, 0.0, 0.0});
  EXPECT_GT(drive.error_of(drive.odom), 0.2);
  EXPECT_LT(drive.error_of(pose), 0.05);
  EXPECT_EQ(harness.state(), ComponentState::active) << harness.reason();
  const auto* tf = harness.latest<tf2_msgs::msg::TFMessage>("/tf");
  ASSERT_EQ(tf->transforms.size(), 1u);
  const auto& t = tf->transforms[0].transform;
  const Pose2 map_to_odom{t.translation.x, t.translation.y, 2.0 * std::atan2(t.rotation.z, t.rotation.w)};
  EXPECT_LT(((map_to_odom * drive.odom).position() - pose.position()).norm(), 1e-9) << "pose and frames agree";
}

TEST(ScanMatchComponent, DoesTheSameEveryTime) {
  const auto trace = [] {
    Harness harness("localization/scan_match");
    Drive drive;
    drive_by_laser(harness, drive, 60);
    return harness.trace_hash();
  };
  EXPECT_EQ(trace(), trace());
}

TEST(ScanMatchComponent, MatchesSonarsToo) {
  Harness harness("localization/scan_match", {{"sensor", "sonar"}});
  Drive drive;
  for (int i = 0; i < 400; ++i) {
    drive.step();
    harness.feed("sonar", sonar_at(harness.now(), drive.truth));
    harness.feed("odom", robot_odometry(harness.now(), drive.odom));
    harness.advance(50ms);
  }
  const Pose2 pose = geometry::pose_of(harness.latest<Odometry>("pose")->pose.pose);
  EXPECT_LT(drive.error_of(pose), 0.5 * drive.error_of(drive.odom));
}

TEST(ScanMatchComponent, SaysThatItsScansDoNotFitTheMap) {
  Harness harness("localization/scan_match");
  Drive drive;
  drive_by_laser(harness, drive, 40);
  for (int i = 0; i < 20; ++i) {
    drive.step();
    LaserScan scan = scan_at(harness.now(), drive.truth);
    for (std::size_t k = 0; k < scan.ranges.size(); ++k) scan.ranges[k] = k % 2 == 0 ? 0.7f : 0.9f;
    harness.feed("scan", scan);
    harness.feed("odom", robot_odometry(harness.now(), drive.odom));
    harness.advance(50ms);
  }
  EXPECT_EQ(harness.state(), ComponentState::degraded);
  EXPECT_EQ(harness.reason(), "what is seen does not fit the map: dead reckoning");
  drive_by_laser(harness, drive, 30);
  EXPECT_EQ(harness.state(), ComponentState::active) << "comes back by itself: " << harness.reason();
}

TEST(ScanMatchComponent, LeavesOutWhatCannotBeAndSaysSo) {
  Harness harness("localization/scan_match");
  Drive drive;
  drive_by_laser(harness, drive, 5);
  LaserScan scan = scan_at(harness.now(), drive.truth);
  scan.ranges.resize(90);
  harness.feed("scan", scan);
  harness.feed("odom", robot_odometry(harness.now(), drive.odom));
  harness.advance(500ms);
  EXPECT_EQ(harness.reason(), "scan: not of this robot, or nothing that could be: left out");
  scan = scan_at(harness.now(), drive.truth);
  scan.ranges[5] = std::numeric_limits<float>::quiet_NaN();
  drive.odom.x += 0.2;
  harness.feed("scan", scan);
  harness.feed("odom", robot_odometry(harness.now(), drive.odom));
  harness.advance(500ms);
  EXPECT_EQ(harness.reason(), "scan: ranges that are no distance are left out");
}

TEST(ScanMatchComponent, SaysThatNothingIsToBeCompared) {
  Harness harness("localization/scan_match");
  for (int i = 0; i < 25; ++i) {
    harness.feed("odom", robot_odometry(harness.now(), {}));
    harness.advance(50ms);
  }
  EXPECT_EQ(harness.reason(), "scan: nothing received yet");
  EXPECT_EQ(harness.take<Odometry>("pose").size(), 25u) << "dead reckoning goes on";
}

TEST(ScanMatchComponent, KeepsToItsMemoryAndSaysSo) {
  Harness harness("localization/scan_match", {{"memory", 0.1}});
  Drive drive;
  drive_by_laser(harness, drive, 10);
  EXPECT_EQ(harness.reason(), "the map may not grow any more, memory is used up: echoes beyond it are left out");
}

TEST(ScanMatchComponent, LeavesOutReadingsThatAreTooOld) {
  Harness harness("localization/scan_match");
  Drive drive;
  drive_by_laser(harness, drive, 29);
  harness.feed("scan", scan_at(harness.now() - 1s, drive.truth));
  harness.advance(100ms);
  EXPECT_EQ(harness.reason(), "scan: readings too old, or without a pose of their time, are left out");
}

TEST(ScanMatchComponent, RefusesSonarsOfAnotherRobot) {
  Harness harness("localization/scan_match", {{"sensor", "sonar"}});
  SonarArray array = sonar_at(harness.now(), {});
  array.field_of_view = 0.3f;
  harness.feed("sonar", array);
  harness.feed("odom", robot_odometry(harness.now(), {}));
  harness.advance(500ms);
  EXPECT_EQ(harness.reason(), "sonar: not of this robot, or nothing that could be: left out");
  array = sonar_at(harness.now(), {});
  array.readings[3].range = -0.5f;
  harness.feed("sonar", array);
  harness.feed("odom", robot_odometry(harness.now(), {}));
  harness.advance(500ms);
  EXPECT_EQ(harness.reason(), "sonar: ranges that are no distance are left out");
}

}  // namespace
}  // namespace kervan::test
