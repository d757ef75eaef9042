// Every shipped robot beside closed forms: how it speeds up, stops, drives arcs, and that it passes no wall.
#include <gtest/gtest.h>

#include <string>

#include "sim/simulation.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

class EveryRobot : public testing::TestWithParam<const char*> {
 protected:
  RobotModel model() const {
    return load_robot_model(KERVAN_SIM_FOLDER "/robots/" + std::string(GetParam()) + ".yaml");
  }

  Simulation alone(Obstacles obstacles = {}, Pose2 start = {}) const {
    RobotSetup setup{.name = "r1", .model = model(), .start = start, .sonar = {.rays = 1}};
    return Simulation(std::make_shared<const World>(std::move(obstacles)), {setup}, 1);
  }

  static const Robot& drive(Simulation& simulation, const Twist2& wanted, Duration time, Duration step = tick) {
    for (const Duration end = simulation.now() + time; simulation.now() < end;) {
      simulation.command(0, wanted);
      simulation.step(step);
    }
    return simulation.robots()[0];
  }
};

TEST_P(EveryRobot, SpeedsUpAsItsLimitsAllow) {
  const DriveLimits limits = model().drive;
  for (const double sign : {1.0, -1.0}) {
    Simulation simulation = alone();
    const double half = 0.5 * limits.speed / limits.acceleration;  // s to half of the speed
    const auto steps = static_cast<int>(half / seconds(tick));
    const Robot& robot = drive(simulation, {sign * 9.0, 0.0}, steps * tick);
    const double t = steps * seconds(tick);
    EXPECT_NEAR(robot.speed().linear, sign * limits.acceleration * t, 1e-9);
    EXPECT_NEAR(robot.pose().x, sign * 0.5 * limits.acceleration * t * t, 1e-9);
    drive(simulation, {sign * 9.0, 0.0}, 10s);
    EXPECT_EQ(robot.speed().linear, sign * limits.speed);
  }
}

TEST_P(EveryRobot, TurnsUpAsItsLimitsAllow) {
  const DriveLimits limits = model().drive;
  Simulation simulation = alone();
  const auto steps = static_cast<int>(0.5 * limits.turn_rate / limits.angular_acceleration / seconds(tick));
  const Robot& robot = drive(simulation, {0.0, -9.0}, steps * tick);
  const double t = steps * seconds(tick);
  EXPECT_NEAR(robot.speed().angular, -limits.angular_acceleration * t, 1e-9);
  EXPECT_NEAR(robot.pose().yaw, -0.5 * limits.angular_acceleration * t * t, 1e-9);
  EXPECT_EQ(robot.pose().position(), Vector2(0.0, 0.0));
  drive(simulation, {0.0, -9.0}, 5s);
  EXPECT_EQ(robot.speed().angular, -limits.turn_rate);
}

TEST_P(EveryRobot, StopsWithinTheDistanceOfFullBraking) {
  const DriveLimits limits = model().drive;
  Simulation simulation = alone();
  const Robot& robot = drive(simulation, {limits.speed, 0.0}, 10s);
  const double before = robot.pose().x;
  drive(simulation, {0.0, 0.0}, 5s);
  EXPECT_EQ(robot.speed().linear, 0.0);
  EXPECT_NEAR(robot.pose().x - before, limits.speed * limits.speed / (2.0 * limits.deceleration), 1e-9);
}

TEST_P(EveryRobot, DrivesTheArcThatIsCommanded) {
  const DriveLimits limits = model().drive;
  const Twist2 wanted{0.5 * limits.speed, 0.3 * limits.turn_rate};
  Simulation simulation = alone();
  const Robot& robot = drive(simulation, wanted, 10s);
  ASSERT_EQ(robot.speed(), wanted);
  // From now on the path is a circle around a point to the left, and a second takes as much of it as the rates say.
  const double radius = wanted.linear / wanted.angular;
  const Pose2 begin = robot.pose();
  const Vector2 center = begin * Vector2(0.0, radius);
  for (int second = 1; second <= 5; ++second) {
    drive(simulation, wanted, 1s);
    const Vector2 expected = center + radius * geometry::heading(begin.yaw - 0.5 * pi + wanted.angular * second);
    EXPECT_NEAR((robot.pose().position() - expected).norm(), 0.0, 1e-8);
    EXPECT_NEAR(geometry::angle_between(robot.pose().yaw, begin.yaw + wanted.angular * second), 0.0, 1e-9);
  }
}

TEST_P(EveryRobot, TurnsAsFarAsTheIntegralOfItsRate) {
  const DriveLimits limits = model().drive;
  const double rate = 0.4 * limits.turn_rate;
  Simulation simulation = alone();
  const Robot& robot = drive(simulation, {0.0, rate}, 2s);
  EXPECT_NEAR(robot.pose().yaw, 2.0 * rate - 0.5 * rate * rate / limits.angular_acceleration, 1e-9);
}

TEST_P(EveryRobot, PassesNoWallOfACentimetreAtFullSpeed) {
  const RobotModel robot_model = model();
  constexpr double face = 4.0;  // m; where the wall begins
  const Obstacles wall{.boxes = {{{face + 0.005, 0.0, 0.0}, {0.01, 40.0}}}};
  for (const double yaw : {0.0, 0.4, -0.9, 1.2})
    for (const Duration step : {10ms, 100ms, 250ms}) {
      Simulation simulation = alone(wall, {0.0, 0.0, yaw});
      double fastest = 0.0;
      for (int i = 0; i < 25'000 / (step / 1ms); ++i) {
        const Robot& robot = drive(simulation, {9.0, 0.0}, step, step);
        fastest = std::max(fastest, robot.speed().linear);
        const Pose2 hull = robot.body().hull();
        for (const Vector2& corner : robot.body().outline().corners()) ASSERT_LT((hull * corner).x(), face);
      }
      EXPECT_EQ(fastest, robot_model.drive.speed) << "it was not at full speed";
      EXPECT_EQ(simulation.robots()[0].body().contacts(), 1u);
      EXPECT_LT(simulation.robots()[0].body().min_clearance(), 1e-5) << "it came up to the wall";
    }
}

INSTANTIATE_TEST_SUITE_P(Physics, EveryRobot, testing::Values("p3dx", "p3at", "k2a", "jackal"),
                         [](const auto& robot) { return std::string(robot.param); });

TEST(Synchro, TheBodyKeepsItsOrientationWhileBaseLinkTurns) {
  const RobotModel k2a = load_robot_model(KERVAN_SIM_FOLDER "/robots/k2a.yaml");
  RobotSetup setup{.name = "r1", .model = k2a, .start = {0.0, 0.0, 0.3}, .sonar = {.noise = 0.0}};
  setup.sonar_period = tick;
  // To be seen there must be something that turns: a long body.
  setup.model.outline = Outline({{0.8, -0.4}, {0.8, 0.4}, {-0.8, 0.4}, {-0.8, -0.4}});
  const Obstacles wall{.segments = {{{3.0, -20.0}, {3.0, 20.0}}}};
  Simulation simulation(std::make_shared<const World>(wall), {setup}, 1);
  const Robot& robot = simulation.robots()[0];
  const std::vector<double> ranges = robot.sonar().ranges;
  for (int i = 0; i < 150; ++i) {
    simulation.command(0, {0.0, 1.0});
    simulation.step(tick);
  }
  ASSERT_GT(robot.pose().yaw, 1.0);
  EXPECT_EQ(robot.body().hull(), (Pose2{0.0, 0.0, 0.3}));
  EXPECT_EQ(robot.sonar().ranges, ranges) << "they look where they looked";
  // In base_link everything on the body has turned back.
  const Pose2 ahead = robot.mounted(k2a.sonars.poses[0]);
  EXPECT_NEAR(ahead.yaw, 0.3 - robot.pose().yaw, 1e-12);
  EXPECT_NEAR((robot.pose() * ahead).yaw, 0.3, 1e-12);
  EXPECT_NEAR((robot.pose() * ahead.position() - robot.body().hull() * k2a.sonars.poses[0].position()).norm(), 0.0,
              1e-12);
}

TEST(Synchro, DrivesWhereBaseLinkLooks) {
  const RobotModel k2a = load_robot_model(KERVAN_SIM_FOLDER "/robots/k2a.yaml");
  Simulation simulation(std::make_shared<const World>(Obstacles{}), {{.name = "r1", .model = k2a, .start = {}}}, 1);
  const Robot& robot = simulation.robots()[0];
  while (robot.pose().yaw < 1.5) {
    simulation.command(0, {0.0, 0.5});
    simulation.step(tick);
  }
  for (int i = 0; i < 500; ++i) {
    simulation.command(0, {0.5, 0.0});
    simulation.step(tick);
  }
  const Vector2 way = robot.pose().position();
  EXPECT_GT(way.norm(), 2.0);
  EXPECT_NEAR(std::atan2(way.y(), way.x()), robot.pose().yaw, 0.02);
}

TEST(Synchro, TurnsAtAWallWithoutTouchingIt) {
  // A square body a millimetre from a wall: one that turned would hit it with its corner.
  RobotModel square = load_robot_model(KERVAN_SIM_FOLDER "/robots/k2a.yaml");
  square.outline = Outline({{0.4, -0.4}, {0.4, 0.4}, {-0.4, 0.4}, {-0.4, -0.4}});
  const Obstacles wall{.segments = {{{0.401, -20.0}, {0.401, 20.0}}}};
  Simulation simulation(std::make_shared<const World>(wall), {{.name = "r1", .model = square, .start = {}}}, 1);
  const Robot& robot = simulation.robots()[0];
  for (int i = 0; i < 200; ++i) {
    simulation.command(0, {0.0, 1.0});
    simulation.step(tick);
    EXPECT_FALSE(robot.stall().left || robot.stall().right);
  }
  EXPECT_GT(std::abs(robot.pose().yaw), 1.5);
  EXPECT_EQ(robot.body().contacts(), 0u);
  EXPECT_NEAR(robot.body().min_clearance(), 0.001, 1e-9);
}

TEST(Synchro, OthersMeetTheBodyAsItStands) {
  // The long body lies along y; were it to turn with base_link, the other robot would meet it earlier.
  RobotModel model = load_robot_model(KERVAN_SIM_FOLDER "/robots/k2a.yaml");
  model.outline = Outline({{0.2, -0.9}, {0.2, 0.9}, {-0.2, 0.9}, {-0.2, -0.9}});
  const RobotSetup standing{.name = "a", .model = model, .start = {}};
  RobotSetup coming = perfect("b", {-3.0, 0.0, 0.0});
  Simulation simulation(std::make_shared<const World>(Obstacles{}), {standing, coming}, 1);
  for (int i = 0; i < 300; ++i) {
    simulation.command(0, {0.0, 1.0});
    simulation.step(tick);
  }
  for (int i = 0; i < 900; ++i) {
    simulation.command(1, {0.5, 0.0});
    simulation.step(tick);
  }
  EXPECT_NEAR(simulation.robots()[1].pose().x, -0.2 - 0.211, 1e-5);
}

}  // namespace
}  // namespace kervan::sim
