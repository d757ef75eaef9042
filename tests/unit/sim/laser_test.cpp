#include "sim/laser.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "sim/simulation.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

const RandomSource source(1, "r1");

/// 181 beams over 180 degrees, 0.1 m before the origin.
LaserMount sick() {
  return {.pose = {0.1, 0.0, 0.0}, .beams = 181, .field_of_view = pi, .min_range = 0.05, .max_range = 8.0};
}

std::vector<double> read(const Surroundings& around, const Pose2& pose, const LaserSettings& settings,
                         std::uint64_t scan = 0, const LaserMount& mount = sick()) {
  std::vector<double> ranges(static_cast<std::size_t>(mount.beams));
  Laser(mount, settings).measure(around, pose, source, scan, ranges);
  return ranges;
}

TEST(Laser, MeasuresAWallAtEveryAngle) {
  const World wall({.segments = {{{2.1, -50.0}, {2.1, 50.0}}}});
  const std::vector<double> ranges = read(wall, {}, {.noise = 0.0});
  for (int i = 0; i < 181; ++i) {
    const double expected = 2.0 / std::cos((i - 90) * pi / 180.0);
    if (expected > 8.0)
      EXPECT_EQ(ranges[i], infinity) << "beam " << i;
    else
      EXPECT_NEAR(ranges[i], expected, 1e-9) << "beam " << i;
  }
}

TEST(Laser, TurnsWithTheRobot) {
  const World wall({.segments = {{{-50.0, 3.0}, {50.0, 3.0}}}});
  const std::vector<double> ranges = read(wall, {1.0, 1.0, 0.5 * pi}, {.noise = 0.0});
  EXPECT_NEAR(ranges[90], 1.9, 1e-9);
  EXPECT_EQ(ranges[0], infinity);
  EXPECT_EQ(ranges[180], infinity);
}

TEST(Laser, TellsTooNearFromNothing) {
  const World rod({.circles = {{{0.15, 0.0}, 0.02}}});
  const std::vector<double> ranges = read(rod, {}, {.noise = 0.0});
  EXPECT_EQ(ranges[90], -infinity);
  EXPECT_EQ(ranges[0], infinity);
}

TEST(Laser, SeesTheBodiesOfOtherRobots) {
  const auto world = std::make_shared<const World>(Obstacles{.segments = {{{4.0, -5.0}, {4.0, 5.0}}}});
  RobotSetup seeing = perfect("r1", {});
  seeing.model.laser = sick();
  seeing.laser.noise = 0.0;
  Simulation simulation(world, {seeing, perfect("r2", {2.0, 0.0, 0.0})}, 1);
  EXPECT_NEAR(simulation.robots()[0].laser().ranges[90], 2.0 - 0.3 - 0.1, 1e-9) << "its tail";
  EXPECT_NEAR(simulation.robots()[0].laser().ranges[60], 3.9 / std::cos(pi / 6.0), 1e-9) << "the wall beside it";
  EXPECT_TRUE(simulation.robots()[1].laser().ranges.empty()) << "it has no laser";
}

TEST(Laser, SweepsAtItsPeriod) {
  const auto world = std::make_shared<const World>(Obstacles{});
  RobotSetup setup = perfect("r1", {});
  setup.model.laser = sick();
  setup.laser_period = 200ms;
  Simulation simulation(world, {setup}, 1);
  for (int i = 1; i <= 50; ++i) {
    simulation.step(tick);
    EXPECT_EQ(simulation.robots()[0].laser().stamp, 200ms * (i / 20)) << "step " << i;
  }
}

TEST(Laser, NoiseIsUniformWithinItsBoundAndDropOutsComeAsOftenAsAsked) {
  const World wall({.segments = {{{2.1, -50.0}, {2.1, 50.0}}}});
  const LaserSettings settings{.noise = 0.005, .drop_out = 0.2};
  double sum = 0.0, squares = 0.0, most = 0.0;
  int heard = 0;
  constexpr int scans = 20000;
  for (int scan = 0; scan < scans; ++scan) {
    const double range = read(wall, {}, settings, static_cast<std::uint64_t>(scan))[90];
    if (range == infinity) continue;
    ++heard;
    const double error = range - 2.0;
    sum += error;
    squares += error * error;
    most = std::max(most, std::abs(error));
  }
  // Five standard deviations of each estimate.
  EXPECT_NEAR(static_cast<double>(heard) / scans, 0.8, 5.0 * std::sqrt(0.8 * 0.2 / scans));
  EXPECT_NEAR(sum / heard, 0.0, 5.0 * 0.005 / std::sqrt(3.0 * heard));
  EXPECT_NEAR(std::sqrt(squares / heard), 0.005 / std::sqrt(3.0), 0.00005);
  EXPECT_LE(most, 0.005);
}

TEST(Laser, RefusesSettingsThatCannotBe) {
  EXPECT_THROW(Laser(sick(), {.noise = -0.1}), std::invalid_argument);
  EXPECT_THROW(Laser(sick(), {.drop_out = 1.1}), std::invalid_argument);
  const auto refused = [](auto change) {
    RobotModel model = p3dx();
    model.laser = sick();
    change(*model.laser);
    try {
      require_valid(model);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_EQ(refused([](LaserMount&) {}), "nothing");
  EXPECT_EQ(refused([](LaserMount& m) { m.beams = 1; }), "robot model p3dx: the laser needs at least 2 beams");
  EXPECT_EQ(refused([](LaserMount& m) { m.field_of_view = 2.0 * pi; }),
            "robot model p3dx: the laser's field of view must be in (0, 2 pi)");
  EXPECT_EQ(refused([](LaserMount& m) { m.min_range = m.max_range; }),
            "robot model p3dx: the laser needs 0 <= min_range < max_range");
}

}  // namespace
}  // namespace kervan::sim
