#include "components/localization/point_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kervan::localization {
namespace {

using geometry::Vector2;

constexpr double resolution = 0.05;

TEST(PointMap, KnowsWhereInACellTheEchoesCameFromOnAverage) {
  PointMap map(resolution, 1 << 20);
  EXPECT_TRUE(map.add({0.0, 0.01}, {1.01, 0.01}));
  EXPECT_TRUE(map.add({0.0, 0.01}, {1.03, 0.03}));
  const PointCell& cell = map.at({20, 0});
  EXPECT_EQ(cell.echoes, 2);
  EXPECT_GT(cell.log_odds, 0);
  EXPECT_NEAR(static_cast<double>(cell.x), -0.1, 1e-5) << "1.02 m is 0.1 cells left of the middle";
  EXPECT_NEAR(static_cast<double>(cell.y), -0.1, 1e-5);
}

TEST(PointMap, IsFreeBetweenTheSensorAndTheEchoAndUnknownBehindIt) {
  PointMap map(resolution, 1 << 20);
  map.add({0.01, 0.01}, {1.01, 0.01});
  for (int x = 0; x < 20; ++x) EXPECT_LT(map.at({x, 0}).log_odds, 0) << x;
  EXPECT_EQ(map.at({21, 0}).log_odds, 0);
  EXPECT_EQ(map.at({10, 1}).log_odds, 0);
  EXPECT_EQ(map.at({1'000'000, 0}).log_odds, 0) << "outside of its box";
}

TEST(PointMap, ForgetsWhatIsSeenThrough) {
  PointMap map(resolution, 1 << 20);
  for (int i = 0; i < 10; ++i) map.add({0.01, 0.01}, {1.01, 0.01});
  ASSERT_TRUE(map.surface({1.0, 0.0}, 0.1).has_value() || map.at({20, 0}).log_odds > 0);
  for (int i = 0; i < 40; ++i) map.add({0.01, 0.01}, {2.01, 0.01});
  EXPECT_LT(map.at({20, 0}).log_odds, 0);
}

TEST(PointMap, LaysALineThroughTheEchoesOfAWall) {
  PointMap map(resolution, 1 << 20);
  const double slope = 0.3;  // rad
  const Vector2 along(std::cos(slope), std::sin(slope)), normal(-along.y(), along.x());
  for (int i = -50; i <= 50; ++i) map.add({0.0, 2.0}, Vector2(1.0, 0.5) + 0.01 * i * along);
  const auto surface = map.surface(Vector2(1.0, 0.5) + 0.08 * normal, 0.15);
  ASSERT_TRUE(surface.has_value());
  EXPECT_NEAR(std::abs(surface->normal.dot(normal)), 1.0, 0.002);
  EXPECT_NEAR((surface->middle - Vector2(1.0, 0.5)).dot(normal), 0.0, 0.005);
  EXPECT_LT(surface->thickness, 0.01);
  EXPECT_FALSE(map.surface(Vector2(1.0, 0.5) + 0.3 * normal, 0.15).has_value()) << "too far away";
}

TEST(PointMap, KnowsNoDirectionOfACornerOrASinglePoint) {
  PointMap map(resolution, 1 << 20);
  map.add({0.0, 0.0}, {1.01, 1.01});
  EXPECT_FALSE(map.surface({1.0, 1.0}, 0.1).has_value()) << "a single point";
  for (int i = 0; i <= 14; ++i) {
    map.add({0.0, 0.0}, {1.01 - 0.01 * i, 1.01});
    map.add({0.0, 0.0}, {1.01, 1.01 - 0.01 * i});
  }
  EXPECT_FALSE(map.surface({1.01, 1.01}, 0.1).has_value()) << "a corner";
}

TEST(PointMap, RefusesWhatIsNowhereOrBeyondItsMemory) {
  PointMap map(resolution, 1 << 20);
  EXPECT_FALSE(map.add({0.0, 0.0}, {1e9, 0.0}));
  EXPECT_FALSE(map.add({std::nan(""), 0.0}, {1.0, 0.0}));
  EXPECT_TRUE(map.add({0.0, 0.0}, {1.0, 0.0}));
  const grid::CellBox before = map.box();
  EXPECT_FALSE(map.add({0.0, 0.0}, {5000.0, 0.0})) << "memory";
  EXPECT_EQ(map.box(), before);
  EXPECT_FALSE(map.surface({1e12, 0.0}, 0.1).has_value());
}

}  // namespace
}  // namespace kervan::localization
