#include "components/safety/drive_guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace kervan::safety {
namespace {

using geometry::Twist2;
using namespace std::chrono_literals;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

Time at(Duration since_start) { return Time(since_start); }

/// A guard that has brought its drive to `speed` with fresh commands; its last command and last step were at `start`.
DriveGuard driving(const Twist2& speed, Time start, const DriveGuardParams& params = {}) {
  DriveGuard guard(params);
  for (Time now = start - 5s; now <= start; now += 50ms) {
    guard.command(now, speed);
    guard.step(now);
  }
  return guard;
}

TEST(DriveGuardLimits, ChangeWhileItDrivesAndAreReachedAtTheAccelerationsTheyHold) {
  DriveGuardParams params;
  params.acceleration = params.deceleration = 1.0;
  DriveGuard guard(params);
  Time now{};
  const auto drive = [&](int steps) {
    for (int i = 0; i < steps; ++i) {
      guard.command(now, {0.8, 0.0});
      guard.step(now);
      now += params.period;
    }
    return guard.output().linear;
  };
  EXPECT_NEAR(drive(20), 0.8, 1e-9);
  params.max_speed = 0.3;
  guard.set_params(params);
  guard.step(now);  // the last command is limited anew, without a next one
  EXPECT_NEAR(guard.output().linear, 0.75, 1e-9);
  EXPECT_NEAR(drive(20), 0.3, 1e-9);
}

TEST(DriveGuard, StandsUntilTheFirstCommand) {
  DriveGuard guard({});
  EXPECT_EQ(guard.step(at(0s)), Twist2{});
  EXPECT_EQ(guard.state(), DriveState::waiting);
}

TEST(DriveGuard, SpeedsUpNoFasterThanItsAcceleration) {
  DriveGuard guard({});
  guard.command(at(0s), {0.5, 1.0});
  const Twist2 first = guard.step(at(0s));
  EXPECT_DOUBLE_EQ(first.linear, 0.3 * 0.05);
  EXPECT_DOUBLE_EQ(first.angular, 1.74 * 0.05);
  EXPECT_EQ(guard.state(), DriveState::following);
}

TEST(DriveGuard, SlowsDownWithItsDeceleration) {
  DriveGuard guard = driving({0.5, 0.0}, at(10s));
  EXPECT_DOUBLE_EQ(guard.output().linear, 0.5);
  guard.command(at(10050ms), {0.1, 0.0});
  EXPECT_DOUBLE_EQ(guard.step(at(10050ms)).linear, 0.5 - 0.6 * 0.05);
}

TEST(DriveGuard, PassesThroughZeroWhenTheDirectionChanges) {
  DriveGuard guard = driving({0.02, 0.0}, at(10s));
  guard.command(at(10050ms), {-0.5, 0.0});
  EXPECT_EQ(guard.step(at(10050ms)).linear, 0.0);
  EXPECT_DOUBLE_EQ(guard.step(at(10100ms)).linear, -0.3 * 0.05);
}

TEST(DriveGuard, LimitsTheSpeed) {
  const DriveGuard guard = driving({9.0, -9.0}, at(10s));
  EXPECT_EQ(guard.output(), (Twist2{1.0, -1.74}));
}

TEST(DriveGuard, KeepsDrivingWhileACommandIsFreshThoughNoNewOneComes) {
  DriveGuard guard = driving({0.5, 0.0}, at(10s));
  for (const Duration age : {50ms, 100ms, 150ms}) {
    EXPECT_EQ(guard.step(at(10s + age)).linear, 0.5) << age.count();
    EXPECT_EQ(guard.state(), DriveState::following);
  }
}

TEST(DriveGuard, BrakesFullySoThatTheDriveHearsOfIt250MillisecondsAfterTheLastFreshCommand) {
  DriveGuard guard = driving({0.5, 1.0}, at(10s));
  for (const Duration age : {50ms, 100ms, 150ms}) guard.step(at(10s + age));
  Twist2 before = guard.output();
  double stands_after = 0.0;
  for (Time now = at(10200ms); stands_after == 0.0; now += 50ms) {
    const Twist2 after = guard.step(now);
    EXPECT_EQ(guard.state(), DriveState::braking);
    EXPECT_NEAR(after.linear, std::max(0.0, before.linear - 0.6 * 0.05), 1e-12);
    EXPECT_NEAR(after.angular, std::max(0.0, before.angular - 1.74 * 0.05), 1e-12);
    before = after;
    if (after == Twist2{}) stands_after = seconds(now - at(10200ms)) + 0.05;
  }
  EXPECT_NEAR(stands_after, 0.5 / 0.6, 0.05);
}

TEST(DriveGuard, NeverDrivesAPeriodInWhichTheCommandTurnsTooOldOnItsWayToTheDrive) {
  for (const Duration travel : {0ms, 10ms, 50ms, 200ms}) {
    DriveGuardParams params;
    params.travel = travel;
    for (const Duration phase : {0ms, 1ms, 10ms, 25ms, 49ms}) {
      DriveGuard guard = driving({0.5, 0.0}, at(10s), params);
      Time now = at(10s + phase);
      while (guard.step(now).linear == 0.5) now += 50ms;
      EXPECT_LE(now, at(10250ms - travel)) << travel.count() << ", " << phase.count();
      EXPECT_GT(now, at(10200ms - travel)) << travel.count() << ", " << phase.count();
    }
  }
}

TEST(DriveGuard, MakesUpForMissedPeriodsWhenItBrakesButNotWhenItSpeedsUp) {
  DriveGuard guard = driving({0.5, 1.0}, at(10s));
  guard.step(at(10200ms));
  const Twist2 before = guard.output();
  EXPECT_EQ(guard.step(at(10350ms)), (Twist2{before.linear - 0.6 * 0.15, before.angular - 1.74 * 0.15}));
  const double braked = guard.output().linear;
  guard.command(at(10450ms), {0.5, 0.0});
  EXPECT_DOUBLE_EQ(guard.step(at(10450ms)).linear, braked + 0.3 * 0.05);
}

TEST(DriveGuard, RefusesACommandThatIsNotFinite) {
  DriveGuard guard({});
  EXPECT_FALSE(guard.command(at(0s), {nan, 0.0}));
  EXPECT_FALSE(guard.command(at(0s), {0.0, nan}));
  EXPECT_FALSE(guard.command(at(0s), {inf, 0.0}));
  EXPECT_FALSE(guard.command(at(0s), {0.0, -inf}));
  EXPECT_EQ(guard.refused(), 4u);
  EXPECT_EQ(guard.step(at(0s)), Twist2{});
  EXPECT_EQ(guard.state(), DriveState::waiting);
}

TEST(DriveGuard, IsNotKeptDrivingByRefusedCommands) {
  DriveGuard guard = driving({0.5, 0.0}, at(10s));
  for (Time now = at(10050ms); now < at(10200ms); now += 50ms) {
    guard.command(now, {nan, nan});
    EXPECT_EQ(guard.step(now).linear, 0.5);
  }
  guard.command(at(10200ms), {nan, nan});
  EXPECT_LT(guard.step(at(10200ms)).linear, 0.5);
}

TEST(DriveGuard, BrakesAtOnceWhenTheLastCommandIsForgotten) {
  DriveGuard guard = driving({0.5, 0.0}, at(10s));
  guard.command(at(10050ms), {0.5, 0.0});
  guard.forget();
  EXPECT_LT(guard.step(at(10050ms)).linear, 0.5);
  EXPECT_EQ(guard.state(), DriveState::braking);
}

TEST(DriveGuard, DrivesOnWhenCommandsComeBack) {
  DriveGuard guard = driving({0.5, 0.0}, at(10s));
  const double braked = guard.step(at(11s)).linear;
  EXPECT_TRUE(guard.command(at(11050ms), {0.5, 0.0}));
  EXPECT_DOUBLE_EQ(guard.step(at(11050ms)).linear, std::min(0.5, braked + 0.3 * 0.05));
  EXPECT_EQ(guard.state(), DriveState::following);
}

TEST(DriveGuard, ObeysItsLimitsWhateverIsCommanded) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> wild(-5.0, 5.0), chance(0.0, 1.0);
  const DriveGuardParams params;
  DriveGuard guard(params);
  Twist2 before;
  for (int i = 0; i < 5000; ++i) {
    const Time now = at(i * params.period);
    if (chance(random) < 0.3) guard.command(now, {chance(random) < 0.1 ? nan : wild(random), wild(random)});
    const Twist2 after = guard.step(now);
    const double limit = std::abs(after.linear) > std::abs(before.linear) ? params.acceleration : params.deceleration;
    ASSERT_LE(std::abs(after.linear), params.max_speed);
    ASSERT_LE(std::abs(after.angular), params.max_turn);
    ASSERT_LE(std::abs(after.linear - before.linear), limit * seconds(params.period) + 1e-12);
    ASSERT_LE(std::abs(after.angular - before.angular), params.turn_acceleration * seconds(params.period) + 1e-12);
    before = after;
  }
}

}  // namespace
}  // namespace kervan::safety
