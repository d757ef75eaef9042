#include "components/localization/laser_localizer.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tests/unit/localization/drifting_drive.hpp"

namespace kervan::localization {
namespace {

using geometry::Pose2;

constexpr std::size_t beams = 121;
constexpr double first_beam = -2.0, spacing = 4.0 / (beams - 1);

std::vector<float> ranges_at(const Pose2& laser, const Walls& walls = room) {
  std::vector<float> ranges;
  for (std::size_t i = 0; i < beams; ++i)
    ranges.push_back(
        static_cast<float>(ray(laser.position(), laser.yaw + first_beam + spacing * static_cast<double>(i), walls)));
  return ranges;
}

geometry::Scan scan_of(const std::vector<float>& ranges) { return {first_beam, spacing, 0.05, 10.0, ranges}; }

LaserLocalizerParams with_mount() {
  LaserLocalizerParams params;
  params.mount = {0.1, 0.0, 0.2};
  return params;
}

struct Driven {
  double localized, by_wheels;
  int count[outcomes] = {};
  OdometryFilter filter;
};

Driven drive(LaserLocalizer& localizer, DriftingDrive& drive, int steps) {
  Driven driven{0.0, 0.0, {}, localizer.filter()};
  for (int i = 0; i < steps; ++i) {
    localizer.filter().odometry(drive.now(), drive.odom());
    ++driven.count[static_cast<int>(
        localizer.scan(drive.odom(), scan_of(ranges_at(drive.truth() * Pose2{0.1, 0.0, 0.2}))))];
    driven.localized = std::max(driven.localized, drive.error_of(localizer.filter().pose()));
    driven.by_wheels = std::max(driven.by_wheels, drive.error_of(drive.odom()));
    drive.step();
  }
  driven.filter = localizer.filter();
  return driven;
}

TEST(LaserLocalizer, KeepsARobotWithBadWheelsInPlace) {
  LaserLocalizer localizer(with_mount());
  DriftingDrive bad(1.03, 0.97);
  const Driven driven = drive(localizer, bad, 3 * 164);  // three rounds
  EXPECT_GT(driven.by_wheels, 0.4);
  EXPECT_LT(driven.localized, 0.06);
  EXPECT_EQ(driven.count[static_cast<int>(Outcome::began)], 1);
  EXPECT_GT(driven.count[static_cast<int>(Outcome::matched)], 200);
  EXPECT_NEAR(driven.filter.turn_scale(), 1.0 / 0.97 - 1.0, 0.01) << "and learns what its wheels are like";
}

TEST(LaserLocalizer, ComparesNothingWhileItStands) {
  LaserLocalizer localizer(with_mount());
  DriftingDrive standing(1.0, 1.0);
  localizer.filter().odometry(standing.now(), standing.odom());
  const auto ranges = ranges_at(standing.truth());
  EXPECT_EQ(localizer.scan(standing.odom(), scan_of(ranges)), Outcome::began);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(localizer.scan(standing.odom(), scan_of(ranges)), Outcome::waiting);
}

TEST(LaserLocalizer, IsLeftToItsWheelsWhereNothingFitsAndKeepsItsMap) {
  LaserLocalizer localizer(with_mount());
  DriftingDrive good(1.0, 1.0);
  drive(localizer, good, 60);
  const auto occupied = [&localizer] {
    std::vector<int> cells;
    for (int y = -50; y < 50; ++y)
      for (int x = -50; x < 50; ++x) cells.push_back(localizer.map().at({x, y}).log_odds);
    return cells;
  };
  const std::vector<int> before = occupied();
  const Walls other = {
      {{-1.0, -1.9}, {1.5, -1.9}}, {{1.5, -1.9}, {1.5, 1.4}}, {{1.5, 1.4}, {-1.6, 1.2}}, {{-1.6, 1.2}, {-1.0, -1.9}}};
  for (int i = 0; i < 30; ++i) {
    localizer.filter().odometry(good.now(), good.odom());
    const Pose2 by_wheels = localizer.filter().pose();
    const Outcome outcome = localizer.scan(good.odom(), scan_of(ranges_at(good.truth(), other)));
    ASSERT_TRUE(outcome == Outcome::poor || outcome == Outcome::waiting || outcome == Outcome::ambiguous) << i;
    EXPECT_EQ(localizer.filter().pose(), by_wheels);
    good.step();
  }
  EXPECT_EQ(occupied(), before);
}

TEST(LaserLocalizer, LeavesOutWhatCannotBeOrIsOfAnotherLaser) {
  LaserLocalizer localizer(with_mount());
  localizer.filter().odometry(Time{}, {});
  std::vector<float> ranges = ranges_at({});
  geometry::Scan scan = scan_of(ranges);
  scan.angle_increment = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(localizer.scan({}, scan), Outcome::refused_scan);
  scan = scan_of(ranges);
  scan.range_max = 0.01;
  EXPECT_EQ(localizer.scan({}, scan), Outcome::refused_scan);
  EXPECT_EQ(localizer.scan({}, scan_of(ranges)), Outcome::began);
  ranges.pop_back();
  EXPECT_EQ(localizer.scan({1.0, 0.0, 0.0}, scan_of(ranges)), Outcome::refused_scan);
}

TEST(LaserLocalizer, CountsRangesThatAreNone) {
  LaserLocalizer localizer(with_mount());
  localizer.filter().odometry(Time{}, {});
  std::vector<float> ranges = ranges_at({});
  ranges[3] = std::numeric_limits<float>::quiet_NaN();
  ranges[7] = -1.0f;
  ranges[8] = -std::numeric_limits<float>::infinity();  // too near, which is no fault
  ranges[9] = 1e30f;                                    // nothing came back
  EXPECT_EQ(localizer.scan({}, scan_of(ranges)), Outcome::began);
  EXPECT_EQ(localizer.refused_ranges(), 2u);
}

}  // namespace
}  // namespace kervan::localization
