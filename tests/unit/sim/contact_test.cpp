#include "sim/contact.hpp"

#include <gtest/gtest.h>

#include <random>

#include "sim/simulation.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

/// A P3-DX in a world of its own, driven with a constant speed.
class Course {
 public:
  Course(Obstacles obstacles, Pose2 start)
      : simulation_(std::make_shared<const World>(std::move(obstacles)), {perfect("r1", start)}, 1) {}

  void drive(const Twist2& wanted, Duration time) {
    for (Duration end = simulation_.now() + time; simulation_.now() < end;) {
      simulation_.command(0, wanted);
      simulation_.step(tick);
    }
  }
  const Robot& robot() const { return simulation_.robots()[0]; }
  const Body& body() const { return robot().body(); }

 private:
  Simulation simulation_;
};

const Obstacles wall{.segments = {{{2.0, -5.0}, {2.0, 5.0}}}};

TEST(Contact, AWallStopsTheRobotAtItsNose) {
  Course course(wall, {0.0, 0.3, 0.0});
  course.drive({0.5, 0.0}, 10s);
  EXPECT_NEAR(course.robot().pose().x, 2.0 - 0.211, 1e-5);
  EXPECT_LT(course.robot().pose().x, 2.0 - 0.211);
  EXPECT_EQ(course.robot().speed().linear, 0.0);
  EXPECT_TRUE(course.body().touching());
  EXPECT_NEAR(course.body().last_contact().point.x(), 2.0, 1e-12);
  EXPECT_NEAR(course.body().last_contact().pose.x, 2.0 - 0.211, 1e-5);
  EXPECT_NEAR(course.body().min_clearance(), 0.0, 1e-5);
}

TEST(Contact, PushingOnIsOneContactAndComingBackIsAnother) {
  Course course(wall, {1.5, 0.0, 0.0});
  course.drive({0.5, 0.0}, 10s);
  EXPECT_EQ(course.body().contacts(), 1u);
  course.drive({-0.2, 0.0}, 2s);
  EXPECT_FALSE(course.body().touching());
  course.drive({0.5, 0.0}, 5s);
  EXPECT_EQ(course.body().contacts(), 2u);
}

TEST(Contact, OdometryStandsStillWithTheWheels) {
  Course course(wall, {0.0, 0.0, 0.0});
  course.drive({0.5, 0.0}, 20s);
  EXPECT_NEAR(course.robot().odometry().pose.x, course.robot().pose().x, 1e-9);
}

TEST(Contact, ARobotWithItsNoseAtAWallCanTurnUntilItsTailTouchesAndLeave) {
  Course course(wall, {1.0, 0.0, 0.6});
  course.drive({0.5, 0.0}, 5s);
  ASSERT_TRUE(course.body().touching());
  const double x = course.robot().pose().x;
  EXPECT_EQ(course.robot().pose().yaw, 0.6);
  course.drive({0.0, 1.0}, 3s);
  // The tail's corner (-0.210, -0.200), 0.29 m from the axis, meets the wall before the robot looks away from it.
  const double room = 2.0 - x;
  EXPECT_NEAR(course.robot().pose().yaw, pi - std::atan2(0.2, 0.21) - std::acos(room / 0.29), 1e-4);
  course.drive({0.5, 0.0}, 4s);
  EXPECT_LT(course.robot().pose().x, x - 0.2);
  EXPECT_FALSE(course.body().touching());
}

TEST(Contact, ARobotWithItsTailAtAWallCanDriveOffWhileItTurnsTowardsIt) {
  // The left side runs 1 cm beside a wall; turning right swings the tail into it.
  Course course({.segments = {{{-3.0, 0.21}, {9.0, 0.21}}}}, {0.0, 0.0, 0.0});
  course.drive({0.0, -1.0}, 500ms);
  ASSERT_TRUE(course.body().touching());
  course.drive({0.5, -0.5}, 5s);
  EXPECT_LT(course.robot().pose().y, -0.3);
  EXPECT_FALSE(course.body().touching());
}

TEST(Contact, MinClearanceIsTheSmallestOnTheWay) {
  Course course({.circles = {{{2.0, 0.65}, 0.3}}}, {0.0, 0.0, 0.0});
  course.drive({0.5, 0.0}, 10s);
  EXPECT_EQ(course.body().contacts(), 0u);
  EXPECT_NEAR(course.body().min_clearance(), 0.65 - 0.3 - 0.2, 1e-4);
}

TEST(Contact, NoStepIsLongEnoughToPassAThinWall) {
  for (const Duration step : {10ms, 100ms, 2000ms, 20000ms}) {
    Body body(p3dx().outline, {0.0, 0.0, 0.0}, World(wall));
    const World world(wall);
    for (int i = 0; i < 3; ++i) body.move({10.0 * seconds(step), 0.001 * i}, world);
    EXPECT_LT(body.pose().x, 2.0 - 0.211 + 1e-9) << seconds(step) << " s";
  }
}

TEST(Contact, WhateverIsDrivenTheBodyNeverEntersAnObstacle) {
  const World world({.segments = {{{-1.0, -1.0}, {1.2, -1.0}},
                                  {{1.2, -1.0}, {1.2, 1.0}},
                                  {{1.2, 1.0}, {-1.0, 1.2}},
                                  {{-1.0, 1.2}, {-1.0, -1.0}}},
                     .circles = {{{0.7, 0.6}, 0.1}},
                     .boxes = {{{-0.7, 0.8, 0.3}, {0.2, 0.3}}}});
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  Body body(p3dx().outline, {0.0, 0.0, 0.0}, world);
  for (int i = 0; i < 3000; ++i) {
    const Motion motion{0.05 * part(random), 0.1 * part(random)};
    for (int k = 0; k < 3; ++k) {
      const Moved moved = body.move(motion, world);
      ASSERT_GT(world.clearance(body.outline(), body.pose()).distance, 0.0);
      EXPECT_LE(std::abs(moved.motion.distance), std::abs(motion.distance) + 1e-12);
      EXPECT_LE(std::abs(moved.motion.turn), std::abs(motion.turn) + 1e-12);
    }
  }
  EXPECT_GT(body.contacts(), 20u);
  EXPECT_TRUE(World(wall).clearance(body.outline(), body.pose()).distance > 0.0) << "it has left the room";
}

TEST(Contact, ABodyMustFitAtItsStart) {
  EXPECT_THROW(Body(p3dx().outline, {1.9, 0.0, 0.0}, World(wall)), std::invalid_argument);
}

}  // namespace
}  // namespace kervan::sim
