#include "components/mapping/laser_mapper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "framework/geometry/angle.hpp"

namespace kervan::mapping {
namespace {

using geometry::Pose2;
using geometry::radians;

constexpr float infinite = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

int percent(const LaserMapper& mapper, double x, double y) {
  std::int8_t value = 0;
  const grid::Cell cell = grid::cell_of({x, y}, mapper.resolution());
  mapper.read_percent({cell.x, cell.y, 1, 1}, {&value, 1});
  return value;
}

/// What a laser at `pose` sees of a room from (-3, -2) to (3, 2).
std::vector<float> room(const Pose2& pose, int beams, double from, double step) {
  std::vector<float> ranges;
  for (int i = 0; i < beams; ++i) {
    const geometry::Vector2 d = geometry::heading(pose.yaw + from + i * step);
    const double x = d.x() > 0 ? (3.0 - pose.x) / d.x() : d.x() < 0 ? (-3.0 - pose.x) / d.x() : 1e9;
    const double y = d.y() > 0 ? (2.0 - pose.y) / d.y() : d.y() < 0 ? (-2.0 - pose.y) / d.y() : 1e9;
    ranges.push_back(static_cast<float>(std::min(x, y) + 1e-4));
  }
  return ranges;
}

geometry::Scan half_circle(const std::vector<float>& ranges) {
  return {radians(-90.0), radians(180.0) / static_cast<double>(ranges.size() - 1), 0.05, 8.0, ranges};
}

TEST(LaserMapper, TellsEachCellOnceAScanHoweverManyBeamsPassIt) {
  LaserMapper mapper({});
  const Pose2 pose{0.31, -0.17, 0.4};
  const auto ranges = room(pose, 181, radians(-90.0), radians(1.0));
  ASSERT_EQ(mapper.add(pose, half_circle(ranges)), ScanResult::added);
  std::set<int> values;
  for (double x = -4.0; x < 4.0; x += 0.05)
    for (double y = -4.0; y < 4.0; y += 0.05) values.insert(percent(mapper, x, y));
  EXPECT_EQ(values, (std::set<int>{-1, 40, 70})) << "unknown, passed once, and met once";
}

TEST(LaserMapper, ClearsTheRoomAndFindsItsWalls) {
  LaserMapper mapper({});
  for (int i = 0; i < 8; ++i) {
    const Pose2 pose{0.1 * i, 0.05 * i, radians(45.0 * i)};
    mapper.add(pose, half_circle(room(pose, 181, radians(-90.0), radians(1.0))));
  }
  for (double x = -2.875; x < 2.9; x += 0.05)
    for (double y = -1.875; y < 1.9; y += 0.05) ASSERT_LT(percent(mapper, x, y), 50) << x << ", " << y;
  int walls = 0;
  for (double x = -2.9; x < 2.9; x += 0.05)
    walls += (percent(mapper, x, 2.025) > 50) + (percent(mapper, x, -2.025) > 50);
  EXPECT_GT(walls, 150) << "of 232";
  for (double x = -4.0; x < 4.0; x += 0.05) {
    const int beyond = percent(mapper, x, 2.125);
    ASSERT_EQ(beyond, -1) << x << ": behind the wall";
  }
}

TEST(LaserMapper, SeesAWholeTurnWithoutAGap) {
  LaserMapper mapper({});
  const Pose2 pose{0.0, 0.0, 0.7};
  for (const int beams : {360, 361, 400}) {  // the last one sees some of it twice
    const auto ranges = room(pose, beams, radians(-180.0), radians(1.0));
    mapper.add(pose, {radians(-180.0), radians(1.0), 0.05, 8.0, ranges});
    for (double x = -2.875; x < 2.9; x += 0.05)
      for (double y = -1.875; y < 1.9; y += 0.05) ASSERT_LT(percent(mapper, x, y) & 0xff, 50) << x << ", " << y;
  }
}

TEST(LaserMapper, StaysWithTheNearerOfTwoBeamsOnTwoThings) {
  LaserMapper mapper({});
  std::vector<float> ranges(181, 2.0f);
  ranges[90] = 6.0f;  // through a crack
  mapper.add({0.025, 0.025, 0.0}, half_circle(ranges));
  EXPECT_EQ(percent(mapper, 4.025, 0.025), -1) << "one beam has no width";
  EXPECT_EQ(percent(mapper, 6.03, 0.025), 70);
  for (int i = 80; i <= 100; ++i) ranges[static_cast<std::size_t>(i)] = 6.0f;
  mapper.add({0.025, 0.025, 0.0}, half_circle(ranges));
  EXPECT_EQ(percent(mapper, 4.025, 0.025), 40);
  EXPECT_EQ(percent(mapper, 4.025, 0.875), -1) << "12 degrees to the left";
}

TEST(LaserMapper, ClearsAsFarAsTheLimitWhereNothingCameBack) {
  for (const float range : {infinite, 8.0f, 100.0f}) {
    LaserMapper cautious({}), bold({.no_echo_limit = 3.0});
    const std::vector<float> ranges(181, range);
    cautious.add({0.025, 0.025, 0.0}, half_circle(ranges));
    bold.add({0.025, 0.025, 0.0}, half_circle(ranges));
    EXPECT_EQ(percent(cautious, 1.025, 0.025), -1);
    EXPECT_EQ(percent(bold, 2.825, 0.025), 40);
    EXPECT_EQ(percent(bold, 3.125, 0.025), -1);
    EXPECT_EQ(percent(bold, 8.025, 0.025), -1);
  }
}

TEST(LaserMapper, UsesFarEndsOnlyToClear) {
  LaserMapper mapper({.max_range = 4.0});
  mapper.add({0.025, 0.025, 0.0}, half_circle(std::vector<float>(181, 6.0f)));
  EXPECT_EQ(percent(mapper, 3.825, 0.025), 40);
  EXPECT_EQ(percent(mapper, 4.125, 0.025), -1);
  EXPECT_EQ(percent(mapper, 6.025, 0.025), -1);
}

TEST(LaserMapper, LeavesOutWhatIsNoDistance) {
  LaserMapper mapper({});
  std::vector<float> ranges(181, 2.0f);
  for (std::size_t i = 85; i <= 95; ++i) ranges[i] = i % 2 ? nan : -1.0f;
  ranges[0] = -infinite;
  EXPECT_EQ(mapper.add({0.025, 0.025, 0.0}, half_circle(ranges)), ScanResult::added);
  EXPECT_EQ(mapper.refused_ranges(), 11u) << "-infinity is a way to say: too near";
  EXPECT_EQ(percent(mapper, 1.025, 0.025), -1);
  EXPECT_EQ(percent(mapper, 1.025, 0.525), 40);
}

TEST(LaserMapper, RefusesScansThatCannotBe) {
  const std::vector<float> ranges(181, 2.0f);
  const double bad = std::numeric_limits<double>::quiet_NaN();
  for (const geometry::Scan& scan : {geometry::Scan{bad, 0.01, 0.0, 8.0, ranges},
                                     {0.0, 0.0, 0.0, 8.0, ranges},
                                     {0.0, bad, 0.0, 8.0, ranges},
                                     {0.0, 0.01, -1.0, 8.0, ranges},
                                     {0.0, 0.01, 8.0, 8.0, ranges},
                                     {0.0, 0.01, 0.0, bad, ranges},
                                     {0.0, 1.0, 0.0, 8.0, ranges}}) {
    LaserMapper mapper({});
    EXPECT_EQ(mapper.add({}, scan), ScanResult::refused_scan);
    EXPECT_TRUE(mapper.box().empty());
  }
  LaserMapper mapper({});
  EXPECT_EQ(mapper.add({bad, 0, 0}, half_circle(ranges)), ScanResult::refused_place);
  EXPECT_EQ(mapper.add({0, 0, bad}, half_circle(ranges)), ScanResult::refused_place);
  EXPECT_EQ(mapper.add({}, {0.0, 0.01, 0.0, 8.0, {}}), ScanResult::added) << "a scan without beams says nothing";
  LaserMapper small({.most_bytes = 64 * 64 * 2});
  EXPECT_EQ(small.add({}, half_circle(ranges)), ScanResult::refused_memory);
}

TEST(LaserMapper, ForgetsWhatWasTakenAwayWithinTwelveScans) {
  LaserMapper mapper({});
  for (int i = 0; i < 100; ++i) mapper.add({0.025, 0.025, 0.0}, half_circle(std::vector<float>(181, 2.0f)));
  ASSERT_EQ(percent(mapper, 2.025, 0.025), 99);
  int needed = 0;
  while (percent(mapper, 2.025, 0.025) > 50 && needed < 100) {
    mapper.add({0.025, 0.025, 0.0}, half_circle(std::vector<float>(181, 4.0f)));
    ++needed;
  }
  EXPECT_EQ(needed, 12);
}

}  // namespace
}  // namespace kervan::mapping
