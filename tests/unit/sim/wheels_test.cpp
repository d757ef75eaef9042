// Stall flags: which wheels an obstacle holds up.
#include "sim/wheels.hpp"

#include <gtest/gtest.h>

#include "sim/simulation.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

constexpr double track = 0.4;
constexpr Stall none{}, both{true, true}, left{true, false}, right{false, true};

TEST(Wheels, RollAsTheBaseMoves) {
  const WheelTravel straight = wheel_travel({0.5, 0.0}, track), spot = wheel_travel({0.0, 1.0}, track),
                    synchro = wheel_travel({0.5, 1.0}, 0.0);
  EXPECT_EQ(straight.left, 0.5);
  EXPECT_EQ(straight.right, 0.5);
  EXPECT_EQ(spot.left, -0.2);
  EXPECT_EQ(spot.right, 0.2);
  EXPECT_EQ(synchro.left, 0.5);
  EXPECT_EQ(synchro.right, 0.5);
}

TEST(Stall, AWheelStallsThatRollsLessFarThanItIsToldTo) {
  const Motion ahead{0.01, 0.0}, curve{0.01, 0.01}, spot{0.0, 0.02};
  EXPECT_EQ(stalled({1.0, 0.0}, ahead, ahead, track), none);
  EXPECT_EQ(stalled({1.0, 0.0}, ahead, {0.004, 0.0}, track), both);
  EXPECT_EQ(stalled({1.0, 1.0}, curve, {0.0, 0.01}, track), both) << "it only turns on";
  EXPECT_EQ(stalled({1.0, 1.0}, curve, {0.01, 0.0}, track), right) << "it only drives on; the left one rolls farther";
  EXPECT_EQ(stalled({1.0, -1.0}, {0.01, -0.01}, {0.01, 0.0}, track), left);
  EXPECT_EQ(stalled({0.0, 1.0}, spot, {0.0, 0.0}, track), both);
  EXPECT_EQ(stalled({-1.0, 0.0}, {-0.01, 0.0}, {0.0, 0.0}, track), both) << "backwards";
}

TEST(Stall, AWheelThatIsNotToldToTurnDoesNotStall) {
  EXPECT_EQ(stalled({0.0, 0.0}, {0.01, 0.0}, {0.0, 0.0}, track), none) << "it was braking when it was stopped";
  EXPECT_EQ(stalled({-1.0, 0.0}, {0.01, 0.0}, {0.0, 0.0}, track), none) << "it was about to reverse";
  EXPECT_EQ(stalled({0.2, 1.0}, {0.0, 0.01}, {0.0, 0.0}, track), right) << "a curve around the left wheel";
}

/// A P3-DX in a world of its own.
class Course {
 public:
  Course(Obstacles obstacles, Pose2 start)
      : simulation_(std::make_shared<const World>(std::move(obstacles)), {perfect("r1", start)}, 1) {}

  /// Drives and collects which flags were seen.
  void drive(const Twist2& wanted, Duration time) {
    seen = {};
    for (const Duration end = simulation_.now() + time; simulation_.now() < end;) {
      simulation_.command(0, wanted);
      simulation_.step(tick);
      seen.left |= robot().stall().left;
      seen.right |= robot().stall().right;
    }
  }
  const Robot& robot() const { return simulation_.robots()[0]; }
  Stall seen;

 private:
  Simulation simulation_;
};

TEST(Stall, BothWheelsStallAsLongAsARobotPushesAgainstAWall) {
  Course course({.segments = {{{2.0, -5.0}, {2.0, 5.0}}}}, {1.0, 0.0, 0.0});
  course.drive({0.3, 0.0}, 2s);
  EXPECT_EQ(course.seen, none) << "on the way to it";
  course.drive({0.3, 0.0}, 3s);
  for (int i = 0; i < 50; ++i) {
    course.drive({0.3, 0.0}, tick);
    EXPECT_EQ(course.robot().stall(), both);
  }
  course.drive({0.0, 0.0}, tick);
  EXPECT_EQ(course.robot().stall(), none) << "it stands at the wall, but nobody tells it to drive";
  ASSERT_TRUE(course.robot().body().touching());
  course.drive({0.0, 0.0}, 1s);
  EXPECT_EQ(course.seen, none);
  course.drive({-0.3, 0.0}, 1s);
  EXPECT_EQ(course.seen, none) << "it drives off";
}

TEST(Stall, ARobotThatTurnsFreelyAtAWallDoesNotStall) {
  Course course({.segments = {{{2.0, -5.0}, {2.0, 5.0}}}}, {1.0, 0.0, 0.6});
  course.drive({0.5, 0.0}, 5s);
  ASSERT_TRUE(course.robot().body().touching());
  ASSERT_EQ(course.robot().stall(), both);
  course.drive({0.0, 0.5}, 1s);
  EXPECT_EQ(course.seen, none);
  EXPECT_GT(course.robot().pose().yaw, 0.8);
}

TEST(Stall, WhatStopsTheTurningOfARobotThatDrivesStallsTheOuterWheel) {
  // The left side runs beside a wall; a curve to the right swings the tail into it.
  Course course({.segments = {{{-9.0, 0.21}, {9.0, 0.21}}}}, {0.0, 0.0, 0.0});
  course.drive({0.0, -1.0}, 500ms);
  ASSERT_EQ(course.robot().stall(), both) << "on the spot both wheels stand still";
  Stall seen;
  for (int i = 0; i < 100; ++i) {
    course.drive({0.5, -0.5}, tick);
    if (course.robot().speed().linear > 0.1) {
      seen.left |= course.robot().stall().left;
      seen.right |= course.robot().stall().right;
    }
  }
  EXPECT_EQ(seen, left);
}

}  // namespace
}  // namespace kervan::sim
