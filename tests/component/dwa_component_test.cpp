#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

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
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A laser in the middle of the robot, 270 degrees with a beam a degree, before a wall across at `distance`, m.
LaserScan wall_ahead(double distance) {
  LaserScan scan;
  scan.angle_min = static_cast<float>(-0.75 * std::numbers::pi);
  scan.angle_increment = static_cast<float>(std::numbers::pi / 180.0);
  scan.range_min = 0.1F;
  scan.range_max = 8.0F;
  for (int beam = 0; beam <= 270; ++beam) {
    const double across = std::cos((beam - 135) * std::numbers::pi / 180.0);
    scan.ranges.push_back(across > 0.0 ? static_cast<float>(distance / across) : infinity);
  }
  return scan;
}

struct DwaDrive {
  explicit DwaDrive(const ValueMap& parameters = {}) : harness("control/dwa", parameters) {
    harness.feed("waypoint", pose_at(3.0, 0.0));
  }

  void feed(LaserScan scan, const geometry::Pose2& robot = {}, const geometry::Twist2& twist = {}) {
    geometry::set_header(scan.header, harness.now(), "laser");
    harness.feed("odom", odometry_at(robot, twist));
    harness.feed("scan", scan);
    harness.advance(50ms);
  }
  const geometry_msgs::msg::Twist& command() const { return harness.latest<TwistStamped>("cmd_vel_raw")->twist; }

  Harness harness;
};

TEST(DwaComponent, DrivesToAWaypointAhead) {
  DwaDrive drive;
  drive.feed(wall_ahead(infinity));
  EXPECT_GT(drive.command().linear.x, 0.5);
  EXPECT_NEAR(drive.command().angular.z, 0.0, 1e-6);
  EXPECT_EQ(drive.harness.state(), ComponentState::active);
}

TEST(DwaComponent, BrakesBeforeAWall) {
  DwaDrive drive;
  drive.feed(wall_ahead(0.65), {}, {1.0, 0.0});
  EXPECT_LT(drive.command().linear.x, 0.5);
}

TEST(DwaComponent, SaysThatItIsHinderedWhenItCannotBrakeInTime) {
  DwaDrive drive;
  drive.feed(wall_ahead(0.40), {}, {1.2, 0.0});
  EXPECT_EQ(drive.command().linear.x, 0.0);
  EXPECT_EQ(drive.harness.state(), ComponentState::degraded);
  EXPECT_EQ(drive.harness.reason(), "no motion leaves room to brake");
}

TEST(DwaComponent, RemembersWhatIsBehindIt) {
  DwaDrive remembers, forgets({{"memory", 0.0}});
  for (DwaDrive* drive : {&remembers, &forgets}) {
    drive->harness.feed("waypoint", pose_at(1.5, 0.0));
    drive->feed(wall_ahead(0.305));
    // It has turned its back to the wall, in narrow surroundings, and the waypoint is beyond it.
    const geometry::Pose2 turned{0.0, 0.0, std::numbers::pi};
    for (int i = 0; i < 3; ++i) drive->feed(wall_ahead(0.305), turned);
  }
  EXPECT_LT(forgets.command().linear.x, -0.1) << "back through the wall";
  EXPECT_GT(remembers.command().linear.x, -0.05);
}

TEST(DwaComponent, StandsAtItsWaypoint) {
  DwaDrive drive;
  drive.feed(wall_ahead(infinity), {2.9, 0.0, 0.0});
  EXPECT_EQ(drive.command().linear.x, 0.0);
  EXPECT_EQ(drive.command().angular.z, 0.0);
}

TEST(DwaComponent, StandsWhileItsLaserIsSilent) {
  DwaDrive drive;
  drive.harness.feed("odom", odometry_at({}));
  drive.harness.advance(100ms);
  EXPECT_EQ(drive.command().linear.x, 0.0);
  EXPECT_EQ(drive.harness.reason(), "scan: nothing received yet");
  drive.feed(wall_ahead(infinity));
  EXPECT_GT(drive.command().linear.x, 0.0);
  for (int i = 0; i < 12; ++i) {
    drive.harness.feed("odom", odometry_at({}));
    drive.harness.advance(50ms);
  }
  EXPECT_EQ(drive.command().linear.x, 0.0);
  EXPECT_EQ(drive.harness.state(), ComponentState::degraded);
}

TEST(DwaComponent, RefusesScansThatAreNone) {
  DwaDrive drive;
  LaserScan scan = wall_ahead(infinity);
  scan.angle_increment = 0.0F;
  drive.feed(scan);
  EXPECT_EQ(drive.command().linear.x, 0.0);
  EXPECT_EQ(drive.harness.reason(), "scan: its angles or limits are none");
  drive.feed(wall_ahead(infinity));
  EXPECT_GT(drive.command().linear.x, 0.0);
}

TEST(DwaComponent, LeavesOutRangesThatAreNoDistance) {
  DwaDrive drive;
  LaserScan scan = wall_ahead(infinity);
  scan.ranges[135] = std::numeric_limits<float>::quiet_NaN();
  scan.ranges[136] = -infinity;
  drive.feed(scan);
  EXPECT_GT(drive.command().linear.x, 0.5);
}

/// One sonar 0.2 m ahead of the middle of the robot, that looks ahead.
kervan_msgs::msg::SonarArray sonar_of(float range) {
  kervan_msgs::msg::SonarArray sonar;
  sonar.field_of_view = 0.5F;
  sonar.min_range = 0.15F;
  sonar.max_range = 5.0F;
  sonar.readings.resize(1);
  sonar.readings[0].x = 0.2F;
  sonar.readings[0].range = range;
  return sonar;
}

TEST(DwaComponent, DrivesBySonarsIfThatIsItsSensor) {
  DwaDrive drive(ValueMap{{"sensor", "sonar"}, {"memory", 1.0}});
  drive.feed(wall_ahead(0.40));
  EXPECT_EQ(drive.harness.reason(), "sonar: nothing received yet") << "the laser is not its sensor";
  const auto hear = [&](float range, double speed) {
    auto sonar = sonar_of(range);
    geometry::set_header(sonar.header, drive.harness.now(), "base_link");
    drive.harness.feed("odom", odometry_at({}, {speed, 0.0}));
    drive.harness.feed("sonar", sonar);
    drive.harness.advance(50ms);
  };
  hear(infinity, 0.5);
  EXPECT_GT(drive.command().linear.x, 0.5);
  hear(0.20F, 1.2);
  EXPECT_EQ(drive.harness.reason(), "no motion leaves room to brake");
  hear(infinity, 1.2);
  EXPECT_EQ(drive.harness.reason(), "no motion leaves room to brake") << "no echo does not say that it was wrong";
  for (int i = 0; i < 25; ++i) hear(std::numeric_limits<float>::quiet_NaN(), 0.5);
  EXPECT_GT(drive.command().linear.x, 0.5) << "forgotten";
}

TEST(DwaComponent, RefusesSonarsWithoutARange) {
  DwaDrive drive(ValueMap{{"sensor", "sonar"}});
  auto sonar = sonar_of(infinity);
  sonar.max_range = sonar.min_range;
  drive.harness.feed("odom", odometry_at({}));
  drive.harness.feed("sonar", sonar);
  drive.harness.advance(50ms);
  EXPECT_EQ(drive.harness.reason(), "sonar: its ranges are none");
  EXPECT_EQ(drive.command().linear.x, 0.0);
}

TEST(DwaComponent, StandsWithInputsThatAreNotFinite) {
  DwaDrive drive;
  drive.feed(wall_ahead(infinity), {}, {nan, 0.0});
  EXPECT_EQ(drive.command().linear.x, 0.0);
  EXPECT_EQ(drive.harness.reason(), "odom: the speed is not finite");
  drive.feed(wall_ahead(infinity), {nan, 0.0, 0.0});
  EXPECT_EQ(drive.harness.reason(), "odom: the pose is not finite");
}

TEST(DwaComponent, ItsSpeedMayBeChangedWhileItRuns) {
  DwaDrive drive;
  drive.feed(wall_ahead(infinity), {}, {0.2, 0.0});
  EXPECT_GT(drive.command().linear.x, 0.21);
  drive.harness.change_parameters({{"v_max", 0.2}});
  drive.feed(wall_ahead(infinity), {}, {0.2, 0.0});
  EXPECT_NEAR(drive.command().linear.x, 0.2, 1e-6);
}

}  // namespace
}  // namespace kervan::test
