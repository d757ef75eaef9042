#include "components/localization/sonar_localizer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/unit/localization/drifting_drive.hpp"

namespace kervan::localization {
namespace {

using geometry::Pose2;

constexpr mapping::SonarLimits limits{0.15, 5.0};

/// Sixteen sonars all round, cones of 30 degrees.
std::vector<SonarEcho> round_at(const Pose2& robot, const Walls& walls = room) {
  std::vector<SonarEcho> echoes;
  for (int i = 0; i < 16; ++i) {
    const Pose2 transducer = Pose2{0.0, 0.0, geometry::radians(22.5 * i)} * Pose2{0.2, 0.0, 0.0};
    const Pose2 at = robot * transducer;
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = -7; k <= 7; ++k)
      nearest = std::min(nearest, ray(at.position(), at.yaw + geometry::radians(2.0 * k), walls));
    echoes.push_back({transducer, nearest});
  }
  return echoes;
}

/// Laps of 3.2 m by 2.4 m, 5 cm a step, turning on the spot at the corners, with wheels that measure 3 % too much of
/// the way and too little of the turns.
struct Laps {
  Pose2 truth{-1.6, -1.3, 0.0}, odom = truth;
  Time now{};

  void step(int i) {
    constexpr int turning = 16, lap = 2 * (64 + 48 + 2 * turning);
    const int of_half = i % (lap / 2);
    const bool turns = (of_half >= 64 && of_half < 64 + turning) || of_half >= 64 + turning + 48;
    const Pose2 moved = turns ? Pose2{0.0, 0.0, geometry::radians(90.0) / turning} : Pose2{0.05, 0.0, 0.0};
    truth = truth * moved;
    odom = odom * Pose2{1.03 * moved.x, 0.0, 0.97 * moved.yaw};
    now += std::chrono::milliseconds(100);
  }
};

/// What the first lap bends cannot be known; after that the map holds the robot.
TEST(SonarLocalizer, KeepsARobotWithBadWheelsNearItsPlace) {
  SonarLocalizer localizer({});
  Laps laps;
  double localized = 0.0, by_wheels = 0.0;
  int matched = 0;
  for (int i = 0; i < 3 * 288; ++i) {
    localizer.filter().odometry(laps.now, laps.odom);
    matched += corrected(localizer.round(laps.odom, round_at(laps.truth), limits));
    localized = std::max(localized, (localizer.filter().pose().position() - laps.truth.position()).norm());
    by_wheels = std::max(by_wheels, (laps.odom.position() - laps.truth.position()).norm());
    laps.step(i);
  }
  EXPECT_GT(by_wheels, 1.0);
  EXPECT_LT(localized, 0.6 * by_wheels);
  EXPECT_GT(matched, 15);
}

TEST(SonarLocalizer, GathersRoundsBeforeItComparesThem) {
  SonarLocalizer localizer({});
  Laps laps;
  std::vector<Outcome> outcomes;
  for (int i = 0; i < 45; ++i) {
    localizer.filter().odometry(laps.now, laps.truth);
    const Outcome outcome = localizer.round(laps.truth, round_at(laps.truth), limits);
    if (outcome != Outcome::waiting) outcomes.push_back(outcome);
    laps.step(i);
  }
  EXPECT_EQ(outcomes, (std::vector{Outcome::began, Outcome::unknown})) << "45 steps of 5 cm, and the next wall is new";
}

TEST(SonarLocalizer, ComparesNothingWhileItStands) {
  SonarLocalizer localizer({});
  localizer.filter().odometry(Time{}, {});
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(localizer.round({}, round_at({}), limits), Outcome::waiting);
  EXPECT_TRUE(localizer.map().box().empty());
}

TEST(SonarLocalizer, LeavesOutRingsThatDoNotFitTheRobot) {
  SonarLocalizer localizer({});
  localizer.filter().odometry(Time{}, {});
  std::vector<SonarEcho> echoes = round_at({});
  EXPECT_EQ(localizer.round({}, {}, limits), Outcome::refused_scan);
  EXPECT_EQ(localizer.round({}, echoes, {0.2, 0.1}), Outcome::refused_scan);
  EXPECT_EQ(localizer.round({}, echoes, limits), Outcome::waiting);
  echoes[2].transducer.x = 20.0;
  EXPECT_EQ(localizer.round({1.0, 0.0, 0.0}, echoes, limits), Outcome::refused_scan);
  echoes = round_at({});
  echoes[2].transducer.yaw = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(localizer.round({1.0, 0.0, 0.0}, echoes, limits), Outcome::refused_scan);
  echoes = round_at({});
  echoes.pop_back();
  EXPECT_EQ(localizer.round({1.0, 0.0, 0.0}, echoes, limits), Outcome::refused_scan);
}

TEST(SonarLocalizer, CountsNegativeRangesAndNotThoseWhoseTurnItWasNot) {
  SonarLocalizer localizer({});
  localizer.filter().odometry(Time{}, {});
  std::vector<SonarEcho> echoes = round_at({});
  echoes[0].range = -0.5;
  echoes[1].range = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(localizer.round({}, echoes, limits), Outcome::waiting);
  EXPECT_EQ(localizer.refused_ranges(), 1u);
}

}  // namespace
}  // namespace kervan::localization
