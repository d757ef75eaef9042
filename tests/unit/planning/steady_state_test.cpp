// A planner that knows its map allocates nothing.
#include <gtest/gtest.h>

#include "components/planning/grid_planner.hpp"
#include "tests/planning/random_maps.hpp"
#include "tests/unit/allocations.hpp"

namespace kervan::planning {
namespace {

TEST(SteadyState, APlanAllocatesNothing) {
  std::mt19937 random(1);
  const grid::CellBox box{0, 0, 200, 150};
  grid::Occupancy cells = test::random_map(random, box, 0.02, 0.05);
  for (const double clearance : {0.0, 0.3})
    for (const bool any_angle : {true, false}) {
      GridPlanner planner({.costs = {.radius = 0.1, .clearance = clearance}, .any_angle = any_angle});
      planner.update(cells, box);
      const auto plan_all = [&](Plan& plan) {
        std::mt19937 places(7);
        const auto at = [&](double high) { return std::uniform_real_distribution(0.0, high)(places); };
        int found = 0;
        for (int i = 0; i < 100; ++i) {
          planner.plan({.start = {at(10.0), at(7.5)}, .goal = {at(10.0), at(7.5)}, .escape = 0.2, .tolerance = 0.2},
                       plan);
          found += plan.outcome == Outcome::found ? 1 : 0;
        }
        return found;
      };
      Plan plan;
      plan_all(plan);
      const std::size_t before = test::allocations();
      const int found = plan_all(plan);
      EXPECT_EQ(test::allocations() - before, 0u);
      EXPECT_GT(found, 50);
    }
}

}  // namespace
}  // namespace kervan::planning
