#include "components/localization/likelihood_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/localization/drawn_map.hpp"

namespace kervan::localization {
namespace {

int value(const LikelihoodField& field, int x, int y) { return int{field.values()[field.index({x, y})]}; }

TEST(LikelihoodField, FallsOffFromWhatIsOccupiedAsAGaussian) {
  DrawnMap map(2.0);
  map.wall({0.025, 0.025}, {0.025, 0.025});
  LikelihoodField field(2.0);
  field.build(map, {-20, -20, 40, 40});
  EXPECT_EQ(value(field, 0, 0), 255);
  for (int d = 1; d <= field.reach(); ++d) {
    EXPECT_NEAR(value(field, d, 0), 255.0 * std::exp(-0.5 * d * d / 4.0), 1.0) << d;
    EXPECT_EQ(value(field, d, 0), value(field, -d, 0));
    EXPECT_EQ(value(field, d, 0), value(field, 0, d));
  }
  EXPECT_EQ(value(field, field.reach() + 1, 0), 0);
}

TEST(LikelihoodField, KnowsWhereInItsCellAWallIs) {
  DrawnMap map(2.0);
  map.wall({0.045, 0.025}, {0.045, 0.025});  // 0.4 cells right of the middle
  LikelihoodField field(2.0);
  field.build(map, {-20, -20, 40, 40});
  EXPECT_NEAR(value(field, 1, 0), 255.0 * std::exp(-0.5 * 0.6 * 0.6 / 4.0), 1.0);
  EXPECT_NEAR(value(field, -1, 0), 255.0 * std::exp(-0.5 * 1.4 * 1.4 / 4.0), 1.0);
}

TEST(LikelihoodField, TakesHalfSureCellsForLess) {
  PointMap map(DrawnMap::resolution, 1 << 20);
  map.add({0.025, 0.025}, {0.025, 0.025});
  for (int i = 0; i < 2; ++i) map.add({0.025, 0.025}, {0.525, 0.025});  // passes through the first one
  LikelihoodField field(2.0);
  field.build(map, {-20, -20, 50, 40});
  EXPECT_NEAR(value(field, 0, 0), 255.0 * (std::log(0.65 / 0.35) - 2.0 * std::log(0.55 / 0.45)) / std::log(0.65 / 0.35),
              2.0);
  EXPECT_EQ(value(field, 10, 0), 255);
}

TEST(LikelihoodField, BoundsWhatIsInReachToTheRightAndAbove) {
  DrawnMap map(2.0);
  map.wall({0.525, -0.5}, {0.225, 0.6}).wall({-0.9, -0.5}, {0.4, -0.6});
  LikelihoodField field(1.5);
  const grid::CellBox box{-25, -25, 50, 45};
  field.build(map, box);
  for (int y = box.y; y < box.y + box.rows; ++y)
    for (int x = box.x; x < box.x + box.columns; ++x) {
      int largest = 0;
      for (int dy = 0; dy < LikelihoodField::bound_side; ++dy)
        for (int dx = 0; dx < LikelihoodField::bound_side; ++dx)
          if (box.contains(grid::Cell{x + dx, y + dy})) largest = std::max(largest, value(field, x + dx, y + dy));
      ASSERT_EQ(int{field.bounds()[field.index({x, y})]}, largest) << x << ", " << y;
    }
}

TEST(LikelihoodField, TellsNothingFarFromAllThatIsKnown) {
  DrawnMap map(1.0);
  map.wall({0.975, -0.9}, {0.975, 0.9});
  LikelihoodField field(2.0);
  field.build(map, {-60, -60, 120, 120});
  EXPECT_TRUE(field.tells({0, 0})) << "known to be free";
  EXPECT_TRUE(field.tells({22, 0})) << "unknown, just behind a wall";
  EXPECT_FALSE(field.tells({50, 0}));
  EXPECT_FALSE(field.tells({-30, 0})) << "unknown, and nothing occupied around";
  EXPECT_FALSE(field.tells({-80, 0})) << "outside";
}

}  // namespace
}  // namespace kervan::localization
