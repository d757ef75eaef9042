#include "components/planning/costmap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/planning/moving_ai.hpp"
#include "tests/planning/random_maps.hpp"

namespace kervan::planning {
namespace {

/// m, from the middle of a cell to the nearest point of an obstacle, by looking at all of them.
double clearance_of(const grid::Occupancy& map, const grid::CellBox& box, int x, int y) {
  double nearest = 1e9;
  for (int oy = box.y; oy < box.y + box.rows; ++oy)
    for (int ox = box.x; ox < box.x + box.columns; ++ox) {
      if (map.at({ox, oy}) <= 50) continue;
      const double dx = ox == x ? 0.0 : std::abs(ox - x) - 0.5, dy = oy == y ? 0.0 : std::abs(oy - y) - 0.5;
      nearest = std::min(nearest, std::hypot(dx, dy) * map.resolution());
    }
  return nearest;
}

TEST(Costmap, WeighsEveryCellByItsExactDistanceToTheNearestObstacle) {
  std::mt19937 random(1);
  const grid::CellBox box{-7, 5, 41, 33};
  const CostmapParams params{.radius = 0.17, .clearance = 0.25, .clearance_cost = 4.0};
  for (int round = 0; round < 5; ++round) {
    grid::Occupancy map = test::random_map(random, box, 0.01, 0.05);
    Costmap costs(params);
    costs.update(map, box);
    for (int y = 0; y < box.rows; ++y)
      for (int x = 0; x < box.columns; ++x) {
        const double distance = clearance_of(map, box, box.x + x, box.y + y);
        const double near = 1.0 - (distance - params.radius) / params.clearance;
        const double wanted = distance == 0.0            ? 0.0
                              : distance < params.radius ? 1.0
                              : near > 0.0               ? std::round(8.0 * (1.0 + 4.0 * near * near))
                                                         : 8.0;
        ASSERT_EQ(costs.weight(costs.index(x + 1, y + 1)), wanted) << x << ", " << y << ": " << distance << " m";
      }
  }
}

TEST(Costmap, AllowsNoMovePastACorner) {
  std::mt19937 random(2);
  const grid::CellBox box{0, 0, 70, 20};
  grid::Occupancy map = test::random_map(random, box, 0.3);
  const Costmap costs = test::bare_costmap(map, box);
  const auto free = [&](int x, int y) { return !costs.blocked(costs.index(x, y)); };
  for (int y = 1; y <= box.rows; ++y)
    for (int x = 1; x <= box.columns; ++x) {
      EXPECT_EQ(free(x, y), map.at({x - 1, y - 1}) == 0);
      EXPECT_EQ(costs.row_bits().bits_from(y, x) & 1u, free(x, y) ? 0u : 1u);
      EXPECT_EQ(costs.column_bits().bits_from(x, y) & 1u, free(x, y) ? 0u : 1u);
      for (std::size_t d = 0; d < directions; ++d) {
        const int to_x = x + step_x[d], to_y = y + step_y[d];
        const bool allowed = free(x, y) && free(to_x, to_y) && free(to_x, y) && free(x, to_y);
        ASSERT_EQ(costs.infos()[costs.index(x, y)] >> d & 1u, allowed ? 1u : 0u) << x << ", " << y << " to " << d;
      }
    }
}

TEST(Costmap, FollowsAChangeAsIfItWereMadeAnew) {
  std::mt19937 random(3);
  const grid::CellBox box{-100, -30, 300, 260};
  grid::Occupancy map = test::random_map(random, box, 0.003, 0.05);
  const CostmapParams params{.radius = 0.2, .clearance = 0.4};
  Costmap followed(params);
  followed.update(map, box);
  for (int round = 0; round < 10; ++round) {
    for (int i = 0; i < 3; ++i) {
      const grid::Cell cell{std::uniform_int_distribution(-100, 199)(random),
                            std::uniform_int_distribution(-30, 229)(random)};
      *map.place(cell) = *map.place(cell) == 0 ? 100 : 0;
      map.touch({cell.x, cell.y, 1, 1});
    }
    followed.update(map, box);
    Costmap anew(params);
    anew.update(map, box);
    for (std::uint32_t cell = 0; cell < anew.cells(); ++cell) {
      ASSERT_EQ(followed.weight(cell), anew.weight(cell)) << "round " << round << ", cell " << cell;
      ASSERT_EQ(followed.infos()[cell], anew.infos()[cell]) << "round " << round << ", cell " << cell;
    }
    for (int y = 1; y <= box.rows; ++y)
      for (int x = 1; x <= box.columns; x += 50)
        ASSERT_EQ(followed.row_bits().bits_from(y, x) << 7, anew.row_bits().bits_from(y, x) << 7);
  }
}

TEST(Costmap, TakesUnknownCellsForWhatItIsTold) {
  grid::Occupancy map(0.1, -1, 1 << 20);
  map.cover({0, 0, 3, 3});
  for (const bool free : {true, false}) {
    Costmap costs({.radius = 0.0, .clearance = 0.0, .unknown_is_free = free});
    costs.update(map, {0, 0, 3, 3});
    EXPECT_EQ(costs.blocked(costs.index(2, 2)), !free);
  }
}

TEST(Costmap, CountsACellAsAnObstacleAboveTheLimitOnly) {
  grid::Occupancy map(0.1, -1, 1 << 20);
  map.cover({0, 0, 2, 1});
  *map.place({0, 0}) = 50;
  *map.place({1, 0}) = 51;
  Costmap costs({.radius = 0.0, .clearance = 0.0});
  costs.update(map, {0, 0, 2, 1});
  EXPECT_FALSE(costs.blocked(costs.index(1, 1)));
  EXPECT_TRUE(costs.blocked(costs.index(2, 1)));
}

TEST(Costmap, RefusesMapsTooWideToBeSearched) {
  grid::Occupancy map(0.1, -1, std::size_t{1} << 24);
  map.cover({0, 0, 70'000, 2});
  Costmap costs({});
  try {
    costs.update(map, {0, 0, 70'000, 2});
    FAIL() << "it was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "the map has 70000 x 2 cells; allowed: at most 65000 along a side");
  }
}

}  // namespace
}  // namespace kervan::planning
