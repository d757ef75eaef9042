#include "sim/gyro.hpp"

#include <gtest/gtest.h>

#include "sim/simulation.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

TEST(Gyro, WithoutErrorItsReadingsAddUpToTheAngleTurned) {
  RobotSetup setup = perfect("r1", {});
  setup.gyro = GyroSettings{};
  setup.gyro_period = 30ms;
  Simulation simulation(std::make_shared<const World>(Obstacles{}), {setup}, 1);
  const Robot& robot = simulation.robots()[0];
  double turned = robot.gyro().rate;
  EXPECT_EQ(turned, 0.0) << "the first reading, at the start";
  for (int i = 0; i < 300; ++i) {
    simulation.command(0, {0.2, i < 150 ? 0.8 : -0.3});
    simulation.step(tick);
    if (robot.gyro().stamp == simulation.now()) turned += robot.gyro().rate * 0.03;
  }
  EXPECT_EQ(robot.gyro().stamp, 3s);
  EXPECT_NEAR(turned, robot.pose().yaw, 1e-12);
}

TEST(Gyro, DoesNotTurnWhenAnObstacleStopsTheTurning) {
  RobotSetup setup = perfect("r1", {});
  setup.gyro = GyroSettings{};
  // The left side 1 cm beside a wall: turning right ends at once.
  const auto wall = std::make_shared<const World>(Obstacles{.segments = {{{-3.0, 0.21}, {3.0, 0.21}}}});
  Simulation simulation(wall, {setup}, 1);
  for (int i = 0; i < 200; ++i) {
    simulation.command(0, {0.0, -1.0});
    simulation.step(tick);
  }
  EXPECT_NEAR(simulation.robots()[0].gyro().rate, 0.0, 1e-3);
}

TEST(Gyro, BiasScaleAndNoiseMatchTheirParametersOver1000Runs) {
  const GyroSettings settings{.bias = 0.01, .scale = 0.02, .noise = 0.005};
  constexpr int runs = 1000;
  constexpr double rate = 0.5;
  double biases = 0.0, scales = 0.0, noises = 0.0;
  for (std::uint64_t seed = 0; seed < runs; ++seed) {
    const RandomSource random(seed, "r1");
    GyroSettings constant = settings;
    constant.noise = 0.0;
    Gyro quiet(constant, random), noisy(settings, random);
    const double bias = quiet.measure(random, 0ms);
    EXPECT_LE(std::abs(bias), settings.bias);
    biases += bias * bias;
    quiet.add(rate * 0.1);
    noisy.add(rate * 0.1);
    const double reading = quiet.measure(random, 100ms);
    const double scale = (reading - bias) / rate - 1.0;
    EXPECT_LE(std::abs(scale), settings.scale + 1e-12);
    scales += scale * scale;
    const double noise = noisy.measure(random, 100ms) - reading;
    noises += noise * noise;
  }
  // The standard deviation of what is even within ± b is b / sqrt(3); its estimate is off by less than 5 / sqrt(2 n).
  const double off = 5.0 / std::sqrt(2.0 * runs);
  EXPECT_NEAR(std::sqrt(biases / runs) / (settings.bias / std::sqrt(3.0)), 1.0, off);
  EXPECT_NEAR(std::sqrt(scales / runs) / (settings.scale / std::sqrt(3.0)), 1.0, off);
  EXPECT_NEAR(std::sqrt(noises / runs) / settings.noise, 1.0, off);
}

TEST(Gyro, NoiseIsThatOfItsTimeAndSeed) {
  const RandomSource random(1, "r1");
  Gyro a({.noise = 0.1}, random), b({.noise = 0.1}, random);
  EXPECT_EQ(a.measure(random, 20ms), b.measure(random, 20ms));
  EXPECT_NE(a.measure(random, 40ms), b.measure(random, 60ms));
}

}  // namespace
}  // namespace kervan::sim
