#include "sim/simulation.hpp"

#include <gtest/gtest.h>

#include "sim/files/world_file.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

std::shared_ptr<const World> lab() {
  static const auto world = std::make_shared<const World>(load_world(KERVAN_SIM_FOLDER "/worlds/lab.yaml"));
  return world;
}

RobotSetup imperfect(std::string name, Pose2 start) {
  RobotSetup setup = perfect(std::move(name), start);
  setup.sonar = {.noise = 0.01, .drop_out = 0.02};
  setup.odometry.drift = 0.03;
  return setup;
}

/// What one robot went through, in one line of numbers.
std::vector<double> history(std::vector<RobotSetup> setups, const std::string& name, std::uint64_t seed) {
  Simulation simulation(lab(), std::move(setups), seed);
  std::vector<double> numbers;
  for (int i = 0; i < 300; ++i) {
    for (std::size_t r = 0; r < simulation.robots().size(); ++r)
      simulation.command(r, {0.1 * static_cast<double>(simulation.robots()[r].name().back() - '0'), 0.01 * (i % 50)});
    simulation.step(tick);
    for (const Robot& robot : simulation.robots()) {
      if (robot.name() != name) continue;
      numbers.insert(numbers.end(), {robot.pose().x, robot.pose().y, robot.odometry().pose.yaw});
      numbers.insert(numbers.end(), robot.sonar().ranges.begin(), robot.sonar().ranges.end());
    }
  }
  return numbers;
}

TEST(Simulation, TheSameSeedGivesTheSameHistoryToTheLastBit) {
  const std::vector<RobotSetup> robots{imperfect("r1", {0.0, 0.0, 0.6})};
  EXPECT_EQ(history(robots, "r1", 3), history(robots, "r1", 3));
  EXPECT_NE(history(robots, "r1", 3), history(robots, "r1", 4));
}

TEST(Simulation, ARobotsHistoryDoesNotDependOnThoseOutOfItsSightOrOnTheirOrder) {
  const RobotSetup a = imperfect("r1", {0.0, 0.0, 0.6}), b = imperfect("r2", {20.0, 2.0, 1.0}),
                   c = imperfect("r3", {12.0, 12.0, -1.0});
  const auto alone = history({b}, "r2", 1);
  EXPECT_EQ(alone, history({a, b, c}, "r2", 1));
  EXPECT_EQ(alone, history({c, b, a}, "r2", 1));
  EXPECT_NE(history({a, b}, "r1", 1), alone);
}

TEST(Simulation, WithoutErrorOdometryIsTheTruth) {
  Simulation simulation(lab(), {perfect("r1", {1.0, 1.0, 0.5})}, 1);
  for (int i = 0; i < 400; ++i) {
    simulation.command(0, {0.5, 0.3});
    simulation.step(tick);
    if (simulation.now() % 50ms != 0ms) continue;
    const Robot& robot = simulation.robots()[0];
    EXPECT_EQ(robot.odometry().pose, robot.pose());
    EXPECT_EQ(robot.odometry().twist, robot.speed());
  }
}

TEST(Simulation, AnArcEndsWhereGeometrySays) {
  RobotSetup setup = perfect("r1", {5.0, 12.0, 0.0});
  setup.model.drive.acceleration = setup.model.drive.angular_acceleration = 1e9;
  Simulation simulation(lab(), {setup}, 1);
  for (int i = 0; i < 100; ++i) {
    simulation.command(0, {0.5, 0.5});
    simulation.step(tick);
  }
  const Pose2 expected = advance({5.0, 12.0, 0.0}, {0.5, 0.5});
  EXPECT_NEAR(simulation.robots()[0].pose().x, expected.x, 1e-8);
  EXPECT_NEAR(simulation.robots()[0].pose().y, expected.y, 1e-8);
  EXPECT_NEAR(simulation.robots()[0].pose().yaw, expected.yaw, 1e-8);
}

TEST(Simulation, EachSensorMeasuresAtItsOwnPeriodBeginningAtOnce) {
  Simulation simulation(lab(), {perfect("r1", {})}, 1);
  EXPECT_EQ(simulation.robots()[0].sonar().stamp, 0ms);
  EXPECT_TRUE(std::isfinite(simulation.robots()[0].sonar().ranges[7])) << "the wall 1.5 m to the right";
  std::vector<Duration> sonar, odometry;
  for (int i = 0; i < 25; ++i) {
    simulation.step(tick);
    const Robot& robot = simulation.robots()[0];
    if (robot.sonar().stamp == simulation.now()) sonar.push_back(simulation.now());
    if (robot.odometry().stamp == simulation.now()) odometry.push_back(simulation.now());
  }
  EXPECT_EQ(sonar, (std::vector<Duration>{100ms, 200ms}));
  EXPECT_EQ(odometry, (std::vector<Duration>{50ms, 100ms, 150ms, 200ms, 250ms}));
}

TEST(Simulation, ARobotWithoutCommandsBrakesFromAQuarterOfASecondOn) {
  Simulation simulation(lab(), {perfect("r1", {})}, 1);
  for (int i = 0; i < 200; ++i) {
    simulation.command(0, {0.5, 0.0});
    simulation.step(tick);
  }
  for (int i = 0; i < 24; ++i) simulation.step(tick);
  EXPECT_EQ(simulation.robots()[0].speed().linear, 0.5);
  simulation.step(tick);
  EXPECT_LT(simulation.robots()[0].speed().linear, 0.5);
}

TEST(Simulation, TheTimeOutOfTheDriveIsTheRobots) {
  RobotSetup setup = perfect("r1", {});
  setup.command_timeout = 100ms;
  Simulation simulation(lab(), {setup}, 1);
  simulation.command(0, {0.5, 0.0});
  for (int i = 0; i < 10; ++i) simulation.step(tick);
  const double fastest = simulation.robots()[0].speed().linear;
  EXPECT_GT(fastest, 0.0);
  simulation.step(tick);
  EXPECT_LT(simulation.robots()[0].speed().linear, fastest);
}

std::string refusal(std::vector<RobotSetup> robots) {
  try {
    Simulation(lab(), std::move(robots), 1);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(Simulation, SaysWhichRobotCannotBe) {
  EXPECT_EQ(refusal({perfect("r1", {}), perfect("r1", {3.0, 3.0, 0.0})}), "two robots have the name r1");
  EXPECT_EQ(refusal({perfect("r1", {8.2, 6.5, 0.0})}), "robot r1 starts in or against an obstacle");
  EXPECT_EQ(refusal({perfect("r1", {1.0, 1.0, 0.0}), perfect("r2", {1.3, 1.0, 0.0})}),
            "robot r2 starts in or against r1");
  RobotSetup setup = perfect("r2", {});
  setup.sonar_period = 0ms;
  EXPECT_EQ(refusal({setup}), "robot r2: the periods of its sensors must be positive");
  setup = perfect("r2", {});
  setup.command_timeout = 0ms;
  EXPECT_EQ(refusal({setup}), "robot r2: the time-out of its drive must be positive");
  setup = perfect("r2", {});
  setup.odometry.drift = 1.5;
  EXPECT_EQ(refusal({setup}), "robot r2: the odometry error must be in [0, 1)");
  setup = perfect("r2", {});
  setup.model.drive.speed = 0.0;
  EXPECT_EQ(refusal({setup}), "robot model p3dx: every limit of the drive must be a positive number");
  setup = perfect("r2", {});
  setup.model.track = 0.0;
  EXPECT_EQ(refusal({setup}), "robot model p3dx: the track of a differential drive must be positive");
  setup = perfect("r2", {});
  setup.model.sonars.arrays = {{0, 1, 2}};
  EXPECT_EQ(refusal({setup}), "robot model p3dx: each sonar must be in one array, and in one only");
  setup = perfect("r2", {});
  setup.sonar.rays = 0;
  EXPECT_EQ(refusal({setup}), "robot r2: a sonar needs at least 1 ray");
  setup = perfect("r2", {});
  setup.touch_range = 0.0;
  EXPECT_EQ(refusal({setup}), "robot r2: the touch range of the bumpers must be positive");
  setup = perfect("r2", {});
  setup.gyro = GyroSettings{.scale = 1.0};
  EXPECT_EQ(refusal({setup}), "robot r2: the scale error of the gyroscope must be in [0, 1)");
}

}  // namespace
}  // namespace kervan::sim
