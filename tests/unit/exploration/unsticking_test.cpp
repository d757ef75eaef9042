#include "components/exploration/unsticking.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kervan::exploration {
namespace {

using namespace std::chrono_literals;
using geometry::Pose2;
using geometry::Twist2;

/// Time until the detector says stuck, of a robot whose place is a function of the time in seconds.
template <class Place>
std::optional<Duration> stuck_after(Place place, Duration limit = 60s) {
  StuckDetector detector({});
  for (Duration t = 0s; t <= limit; t += 50ms)
    if (detector.look(Time(t), place(seconds(t)), true)) return t;
  return std::nullopt;
}

TEST(StuckDetector, FourSecondsAtOnePlaceAreStuck) {
  EXPECT_EQ(stuck_after([](double) { return geometry::Vector2(1, 2); }), Duration(4s));
}

TEST(StuckDetector, ATenthOfAMetreInFourSecondsIsEnough) {
  EXPECT_FALSE(stuck_after([](double t) { return geometry::Vector2(0.026 * t, 0); }));
  EXPECT_TRUE(stuck_after([](double t) { return geometry::Vector2(0.024 * t, 0); }));
}

TEST(StuckDetector, ToAndFroAtOnePlaceIsStuck) {
  EXPECT_TRUE(stuck_after([](double t) { return geometry::Vector2(0.09 * std::sin(t), 0); }));
}

TEST(StuckDetector, WhoIsToldToStandIsNot) {
  StuckDetector detector({});
  for (Duration t = 0s; t < 60s; t += 50ms) EXPECT_FALSE(detector.look(Time(t), {0, 0}, false));
}

TEST(StuckDetector, PausesDoNotCountButDoNotBeginAnewEither) {
  StuckDetector detector({});
  Duration t = 0s;
  for (; t < 3s; t += 50ms) EXPECT_FALSE(detector.look(Time(t), {0, 0}, true));
  for (; t < 30s; t += 50ms) EXPECT_FALSE(detector.look(Time(t), {0, 0}, false));
  bool stuck = false;
  for (; t < 31500ms && !stuck; t += 50ms) stuck = detector.look(Time(t), {0, 0}, true);
  EXPECT_TRUE(stuck);
  detector.reset();
  EXPECT_FALSE(detector.look(Time(t), {0, 0}, true));
}

/// A robot that does at once what it is told; `wall`: it does not get behind this x.
Pose2 driven(BackOff& manoeuvre, double turn, double wall, Duration& t, bool can_turn = true) {
  Pose2 pose;
  manoeuvre.start(Time(t), pose, turn);
  while (const auto twist = manoeuvre.step(Time(t), pose)) {
    const double step = 0.02;
    pose.x = std::max(wall, pose.x + step * twist->linear * std::cos(pose.yaw));
    pose.y += step * twist->linear * std::sin(pose.yaw);
    if (can_turn) pose.yaw = geometry::wrap_angle(pose.yaw + step * twist->angular);
    t += 20ms;
    if (t > 1min) break;
  }
  return pose;
}

TEST(BackOff, BacksHalfAMetreAndTurns) {
  for (const double turn : {2.0, -2.0, 3.1, -3.1}) {
    BackOff manoeuvre({});
    Duration t = 0s;
    const Pose2 pose = driven(manoeuvre, turn, -10, t);
    EXPECT_NEAR(pose.x, -0.5, 0.01);
    EXPECT_NEAR(pose.y, 0.0, 1e-9);
    EXPECT_NEAR(geometry::angle_between(pose.yaw, turn), 0.0, 0.02) << turn;
    EXPECT_FALSE(manoeuvre.active());
    EXPECT_FALSE(manoeuvre.step(Time(t), pose));
  }
}

TEST(BackOff, TurnsWhereItIsIfSomethingIsBehind) {
  BackOff manoeuvre({});
  Duration t = 0s;
  const Pose2 pose = driven(manoeuvre, 2.0, -0.1, t);
  EXPECT_NEAR(pose.x, -0.1, 1e-9);
  EXPECT_NEAR(pose.yaw, 2.0, 0.02);
}

TEST(BackOff, EndsIfItCanDoNeither) {
  BackOff manoeuvre({});
  Duration t = 0s;
  driven(manoeuvre, 2.0, 0.0, t, false);
  EXPECT_FALSE(manoeuvre.active());
  EXPECT_LT(t, 12s);
}

}  // namespace
}  // namespace kervan::exploration
