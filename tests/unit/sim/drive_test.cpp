#include "sim/drive.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

/// A drive that gets a fresh command before every tick.
class Driven {
 public:
  void run(const Twist2& wanted, Duration time) {
    for (const Duration end = now + time; now < end; now += tick) {
      drive.command(wanted, now);
      take(drive.step(now, tick));
    }
  }
  void run_without_commands(Duration time) {
    for (const Duration end = now + time; now < end; now += tick) take(drive.step(now, tick));
  }

  Drive drive{p3dx().drive};
  Duration now{0};
  double distance = 0.0;
  double turn = 0.0;

 private:
  void take(const Motion& motion) {
    distance += motion.distance;
    turn += motion.turn;
  }
};

TEST(Advance, FollowsACircleExactly) {
  constexpr double radius = 2.0;
  const Pose2 quarter = advance({1.0, 1.0, 0.0}, {0.5 * pi * radius, 0.5 * pi});
  EXPECT_NEAR(quarter.x, 3.0, 1e-12);
  EXPECT_NEAR(quarter.y, 3.0, 1e-12);
  EXPECT_NEAR(quarter.yaw, 0.5 * pi, 1e-12);
}

TEST(Advance, DoesNotDependOnHowAnArcIsCutIntoSteps) {
  const Pose2 once = advance({1.0, 2.0, 0.7}, {3.0, -2.0});
  Pose2 pose{1.0, 2.0, 0.7};
  for (int i = 0; i < 1000; ++i) pose = advance(pose, {0.003, -0.002});
  EXPECT_NEAR(pose.x, once.x, 1e-10);
  EXPECT_NEAR(pose.y, once.y, 1e-10);
  EXPECT_NEAR(pose.yaw, once.yaw, 1e-10);
}

TEST(Advance, DrivesStraightAndTurnsOnTheSpot) {
  EXPECT_EQ(advance({1.0, 2.0, 0.0}, {-0.5, 0.0}), (Pose2{0.5, 2.0, 0.0}));
  EXPECT_EQ(advance({1.0, 2.0, 3.0}, {0.0, -3.0}), (Pose2{1.0, 2.0, 0.0}));
}

TEST(Drive, SpeedsUpWithItsAcceleration) {
  Driven robot;
  robot.run({0.5, 0.0}, 1s);
  EXPECT_NEAR(robot.drive.speed().linear, 0.3, 1e-9);
  EXPECT_NEAR(robot.distance, 0.5 * 0.3, 1e-9);
  robot.run({0.5, 0.0}, 1s);
  EXPECT_NEAR(robot.drive.speed().linear, 0.5, 1e-12);
}

TEST(Drive, StopsWithinTheDistanceOfFullBraking) {
  Driven robot;
  robot.run({0.5, 0.0}, 5s);
  const double before = robot.distance;
  robot.run({0.0, 0.0}, 2s);
  EXPECT_EQ(robot.drive.speed().linear, 0.0);
  EXPECT_NEAR(robot.distance - before, 0.5 * 0.5 / (2 * 0.6), 1e-9);
}

TEST(Drive, ReversesByBrakingFirstAndSpeedingUpAfterwards) {
  Driven robot;
  robot.run({0.5, 0.0}, 5s);
  robot.run({-0.5, 0.0}, 830ms);  // stands after 0.8333 s
  EXPECT_NEAR(robot.drive.speed().linear, 0.5 - 0.6 * 0.83, 1e-9);
  robot.run({-0.5, 0.0}, 10ms);
  EXPECT_NEAR(robot.drive.speed().linear, -0.3 * (0.84 - 0.5 / 0.6), 1e-9);
  robot.run({-0.5, 0.0}, 1s);
  EXPECT_NEAR(robot.drive.speed().linear, -0.3 * (1.84 - 0.5 / 0.6), 1e-9);
}

TEST(Drive, BrakesWhenDrivingBackwardsToo) {
  Driven robot;
  robot.run({-0.5, 0.0}, 5s);
  const double before = robot.distance;
  robot.run({0.0, 0.0}, 2s);
  EXPECT_NEAR(robot.distance - before, -0.5 * 0.5 / (2 * 0.6), 1e-9);
}

TEST(Drive, TurnsWithItsAngularAcceleration) {
  Driven robot;
  robot.run({0.0, -1.0}, 500ms);
  EXPECT_NEAR(robot.drive.speed().angular, -0.87, 1e-9);
  EXPECT_NEAR(robot.turn, -0.5 * 1.74 * 0.25, 1e-9);
}

TEST(Drive, NeverExceedsItsLimits) {
  Driven robot;
  robot.run({9.0, -9.0}, 10s);
  EXPECT_EQ(robot.drive.speed(), (Twist2{1.0, -1.74}));
}

TEST(Drive, BeginsFullBrakingAQuarterOfASecondAfterTheLastCommand) {
  Driven robot;
  robot.run({0.5, 0.0}, 5s);  // the last command comes 10 ms before now
  robot.run_without_commands(240ms);
  EXPECT_EQ(robot.drive.speed().linear, 0.5) << "250 ms after the command";
  robot.run_without_commands(10ms);
  EXPECT_NEAR(robot.drive.speed().linear, 0.5 - 0.006, 1e-12) << "260 ms after the command";
  robot.run_without_commands(820ms);
  EXPECT_GT(robot.drive.speed().linear, 0.0);
  robot.run_without_commands(10ms);
  EXPECT_EQ(robot.drive.speed().linear, 0.0);
}

TEST(Drive, AStepThatWouldOutliveTheCommandIsBrakedFromItsBeginning) {
  Drive drive(p3dx().drive);
  drive.command({0.5, 0.0}, 0ms);
  drive.step(0ms, 200ms);
  const double before = drive.speed().linear;
  drive.step(200ms, 100ms);
  EXPECT_LT(drive.speed().linear, before);
}

TEST(Drive, StandsWithoutAnyCommand) {
  Driven robot;
  robot.run_without_commands(1s);
  EXPECT_EQ(robot.distance, 0.0);
}

TEST(Drive, ACommandThatIsNoNumberIsRefusedAndDoesNotKeepTheDriveGoing) {
  Driven robot;
  robot.run({0.5, 0.0}, 5s);
  robot.run({std::numeric_limits<double>::quiet_NaN(), 0.0}, 3s);
  EXPECT_EQ(robot.drive.speed().linear, 0.0);
  EXPECT_EQ(robot.drive.refused_commands(), 300u);
}

}  // namespace
}  // namespace kervan::sim
