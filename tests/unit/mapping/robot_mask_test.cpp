#include "components/mapping/robot_mask.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "framework/geometry/angle.hpp"

namespace kervan::mapping {
namespace {

using geometry::radians;
using geometry::Vector2;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The ranges of a half circle of 181 beams, 3 m each, without the robots.
std::vector<float> masked(const geometry::Pose2& laser, const std::vector<Vector2>& robots, float range = 3.0f) {
  const std::vector<float> seen(181, range);
  std::vector<float> ranges = seen;
  mask_robots(laser, {radians(-90.0), radians(1.0), 0.05, 8.0, seen}, robots, 0.5, ranges);
  return ranges;
}

bool left_out(float range) { return range == -std::numeric_limits<float>::infinity(); }

TEST(RobotMask, LeavesOutTheBeamsThatEndOnARobotAndNoOthers) {
  // 3 m before the laser: up to 2 asin(0.25 / 3) = 9.56 degrees to either side are within 0.5 m of it.
  const auto ranges = masked({1.0, 2.0, radians(90.0)}, {{1.0, 5.0}});
  for (int i = 0; i < 181; ++i) EXPECT_EQ(left_out(ranges[static_cast<std::size_t>(i)]), std::abs(i - 90) <= 9) << i;
}

TEST(RobotMask, KeepsWhatLiesBeforeAndBehindARobot) {
  for (const double distance : {2.4, 3.6, 20.0})
    for (const float range : masked({}, {{distance, 0.0}})) EXPECT_EQ(range, 3.0f) << distance;
  for (const double distance : {2.6, 3.4}) EXPECT_TRUE(left_out(masked({}, {{distance, 0.0}})[90])) << distance;
}

TEST(RobotMask, LeavesOutSeveralRobotsAndSkipsThoseThatAreNowhere) {
  const auto ranges = masked({}, {{nan, 0.0}, {3.0, 0.0}, {0.0, 3.0}});
  EXPECT_TRUE(left_out(ranges[90]));
  EXPECT_TRUE(left_out(ranges[180]));
  EXPECT_EQ(ranges[135], 3.0f);
  for (const float range : masked({nan, 0.0, 0.0}, {{3.0, 0.0}})) EXPECT_EQ(range, 3.0f);
}

TEST(RobotMask, KeepsRangesThatAreNone) {
  for (const float range : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    for (const float kept : masked({}, {{3.0, 0.0}}, range)) EXPECT_FALSE(left_out(kept)) << range;
}

}  // namespace
}  // namespace kervan::mapping
