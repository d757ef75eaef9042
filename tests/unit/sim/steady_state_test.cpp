// A step allocates nothing, whatever happens in it.
#include <gtest/gtest.h>

#include "sim/simulation.hpp"
#include "tests/unit/allocations.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

TEST(SteadyState, AStepAllocatesNothing) {
  std::vector<RobotSetup> setups;
  for (int i = 0; i < 25; ++i) {
    setups.push_back(perfect("r" + std::to_string(i), {0.8 * (i % 5), 0.8 * (i / 5), 0.5 * i}));
    setups.back().model.laser = LaserMount{.pose = {}, .beams = 181, .field_of_view = pi, .max_range = 8.0};
    if (i % 12 == 6) setups.back() = with_everything(std::move(setups.back()));
  }
  const auto world = std::make_shared<const World>(Obstacles{
      .segments = {{{-1.0, -1.0}, {5.0, -1.0}}, {{-1.0, -1.0}, {-1.0, 5.0}}}, .circles = {{{4.5, 4.5}, 0.3}}});
  for (const int threads : {1, 2}) {
    Simulation simulation(world, setups, 1, threads);
    const auto run = [&](int steps) {
      for (int i = 0; i < steps; ++i) {
        for (std::size_t robot = 0; robot < setups.size(); ++robot) simulation.command(robot, {0.4, 0.1});
        simulation.step(tick);
      }
    };
    run(1);
    const std::size_t before = test::allocations();
    run(300);
    EXPECT_EQ(test::allocations() - before, 0u) << threads << " threads";
    std::uint64_t contacts = 0;
    for (const Robot& robot : simulation.robots()) contacts += robot.body().contacts();
    EXPECT_GT(contacts, 10u) << "contacts were among the steps";
  }
}

}  // namespace
}  // namespace kervan::sim
