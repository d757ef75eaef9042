#include "components/mapping/posed_readings.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace kervan::mapping {
namespace {

using namespace std::chrono_literals;
using geometry::Pose2;

Time at(Duration since) { return Time(since); }

struct Placed {
  double x;
  int reading;
  bool operator==(const Placed&) const = default;
};

std::vector<Placed> released(PosedReadings<int>& readings, Time now) {
  std::vector<Placed> placed;
  readings.release(now, [&](const Pose2& pose, int reading, Time) { placed.push_back({pose.x, reading}); });
  return placed;
}

TEST(PosedReadings, LieBetweenThePosesBeforeAndAfterThem) {
  PosedReadings<int> readings(500ms);
  readings.pose(at(100ms), {1.0, 0.0, 0.0});
  readings.reading(at(125ms), at(125ms), 7);
  EXPECT_TRUE(released(readings, at(130ms)).empty()) << "where the robot was is not known yet";
  readings.pose(at(150ms), {2.0, 0.0, 0.0});
  EXPECT_EQ(released(readings, at(150ms)), (std::vector<Placed>{{1.5, 7}}));
  EXPECT_TRUE(released(readings, at(150ms)).empty());
  readings.reading(at(150ms), at(151ms), 8);
  EXPECT_EQ(released(readings, at(151ms)), (std::vector<Placed>{{2.0, 8}}));
}

TEST(PosedReadings, TurnTheShortWay) {
  PosedReadings<int> readings(500ms);
  readings.pose(at(0ms), {0.0, 0.0, 3.0});
  readings.pose(at(100ms), {0.0, 0.0, -3.0});
  readings.reading(at(50ms), at(50ms), 1);
  readings.release(at(100ms), [](const Pose2& pose, int, Time) { EXPECT_NEAR(std::abs(pose.yaw), 3.14159, 1e-5); });
}

TEST(PosedReadings, FromBeforeTheFirstPoseAreDroppedAndCounted) {
  PosedReadings<int> readings(500ms);
  readings.pose(at(100ms), {});
  readings.reading(at(99ms), at(100ms), 1);
  readings.reading(at(100ms), at(100ms), 2);
  EXPECT_EQ(released(readings, at(100ms)), (std::vector<Placed>{{0.0, 2}}));
  EXPECT_EQ(readings.unplaced(), 1u);
}

TEST(PosedReadings, OlderThanTheirLargestAgeAreDroppedAndCounted) {
  PosedReadings<int> readings(500ms);
  readings.reading(at(0ms), at(0ms), 1);
  EXPECT_TRUE(released(readings, at(500ms)).empty());
  EXPECT_EQ(readings.late(), 0u) << "it may still be placed";
  EXPECT_TRUE(released(readings, at(501ms)).empty());
  EXPECT_EQ(readings.late(), 1u);
  readings.pose(at(1000ms), {});
  readings.reading(at(499ms), at(1000ms), 2);
  released(readings, at(1000ms));
  EXPECT_EQ(readings.late(), 2u) << "taken long ago, and only now here";
}

TEST(PosedReadings, WaitInABoundedNumber) {
  PosedReadings<int> readings(500ms);
  for (int i = 0; i < 1000; ++i) readings.reading(at(0ms), at(0ms), i);
  readings.pose(at(0ms), {});
  EXPECT_EQ(released(readings, at(1ms)).size(), 64u);
  EXPECT_EQ(readings.unplaced(), 936u);
}

TEST(PosedReadings, LeaveOutPosesThatAreNotFinite) {
  PosedReadings<int> readings(500ms);
  readings.pose(at(0ms), {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  EXPECT_FALSE(readings.has_pose());
  EXPECT_EQ(readings.bad_poses(), 1u);
}

TEST(PosedReadings, BeginAnewWhenTheClockOfThePosesDoes) {
  PosedReadings<int> readings(500ms);
  readings.pose(at(100s), {1.0, 0.0, 0.0});
  readings.pose(at(10ms), {2.0, 0.0, 0.0});
  readings.reading(at(10ms), at(101s), 1);
  EXPECT_EQ(released(readings, at(101s)), (std::vector<Placed>{{2.0, 1}}));
}

}  // namespace
}  // namespace kervan::mapping
