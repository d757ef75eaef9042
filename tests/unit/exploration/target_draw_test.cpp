#include "components/exploration/target_draw.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

namespace kervan::exploration {
namespace {

using geometry::Vector2;

/// A room of 10 m by 6 m with a disc and a box.
Obstacles room() {
  Obstacles obstacles;
  obstacles.walls = {{{0, 0}, {10, 0}}, {{10, 0}, {10, 6}}, {{10, 6}, {0, 6}}, {{0, 6}, {0, 0}}};
  obstacles.circles = {{{2, 3}, 0.5}};
  obstacles.polygons = {{{6, 2}, {8, 2}, {8, 4}, {6, 4}}};
  return obstacles;
}

const Area floor_area{{0, 0}, {10, 6}};

TEST(TargetDraw, DistanceIsThatToTheNearestSurfaceAndNoneWithinASolid) {
  const Obstacles obstacles = room();
  EXPECT_NEAR(obstacles.distance({4, 0.25}), 0.25, 1e-12);
  EXPECT_NEAR(obstacles.distance({3, 3}), 0.5, 1e-12);
  EXPECT_EQ(obstacles.distance({2.2, 3}), 0.0);
  EXPECT_EQ(obstacles.distance({7, 3}), 0.0);
  EXPECT_NEAR(obstacles.distance({5.5, 3}), 0.5, 1e-12);
  EXPECT_EQ(Obstacles().distance({1, 1}), std::numeric_limits<double>::infinity());
}

TEST(TargetDraw, TargetsHaveRoomAndLieAllOverTheArea) {
  const Obstacles obstacles = room();
  Vector2 low(10, 6), high(0, 0);
  for (std::uint64_t k = 0; k < 500; ++k) {
    const auto target = draw_target(7, k, floor_area, obstacles, 0.4);
    ASSERT_TRUE(target);
    EXPECT_GE(obstacles.distance(*target), 0.4);
    low = low.cwiseMin(*target);
    high = high.cwiseMax(*target);
  }
  EXPECT_LT((low - Vector2(0.4, 0.4)).norm(), 0.5);
  EXPECT_LT((high - Vector2(9.6, 5.6)).norm(), 0.5);
}

TEST(TargetDraw, DependsOnSeedAndNumberAlone) {
  const auto third = draw_target(1, 3, floor_area, room(), 0.4);
  for (std::uint64_t k = 0; k < 3; ++k) draw_target(1, k, floor_area, room(), 0.4);
  EXPECT_EQ(draw_target(1, 3, floor_area, room(), 0.4), third);
  EXPECT_NE(draw_target(2, 3, floor_area, room(), 0.4), third);
  EXPECT_NE(draw_target(1, 4, floor_area, room(), 0.4), third);
}

TEST(TargetDraw, ThereIsNoneWhereNothingHasRoom) {
  EXPECT_FALSE(draw_target(1, 0, floor_area, room(), 4.0));
  EXPECT_FALSE(draw_target(1, 0, {{6.5, 2.5}, {7.5, 3.5}}, room(), 0.1)) << "all of it lies within the box";
}

TEST(TargetDraw, TheAreaAroundObstaclesHoldsThemAll) {
  Obstacles obstacles = room();
  obstacles.circles.push_back({{11, 3}, 0.5});
  const auto area = area_around(obstacles);
  ASSERT_TRUE(area);
  EXPECT_EQ(area->low, Vector2(0, 0));
  EXPECT_EQ(area->high, Vector2(11.5, 6));
  EXPECT_FALSE(area_around({}));
}

TEST(TargetDraw, NumbersAreUniformAndDiffer) {
  std::set<double> seen;
  double sum = 0.0;
  for (std::uint64_t k = 0; k < 100; ++k)
    for (std::uint64_t j = 0; j < 100; ++j) {
      const double number = uniform(5, k, j);
      ASSERT_TRUE(number >= 0.0 && number < 1.0);
      sum += number;
      seen.insert(number);
    }
  EXPECT_NEAR(sum / 10'000, 0.5, 0.01);
  EXPECT_EQ(seen.size(), 10'000u);
}

}  // namespace
}  // namespace kervan::exploration
