#include "components/exploration/visit_counter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kervan::exploration {
namespace {

using geometry::Vector2;
using Points = std::vector<Vector2>;

/// Drives along straight lines in steps of 5 cm.
void drive(VisitCounter& counter, const Points& way) {
  for (std::size_t i = 1; i < way.size(); ++i) {
    const int steps = static_cast<int>(std::ceil((way[i] - way[i - 1]).norm() / 0.05));
    for (int step = 0; step <= steps; ++step)
      while (counter.look(way[i - 1] + static_cast<double>(step) / steps * (way[i] - way[i - 1]))) {
      }
  }
}

TEST(VisitCounter, APointLiesEveryMetreAlongTheRoute) {
  VisitCounter counter({});
  counter.begin({0, 0});
  counter.route(Points{{0, 0}, {2.5, 0}, {2.5, 2.0}});
  const auto ahead = counter.ahead();
  ASSERT_EQ(ahead.size(), 4u);
  EXPECT_LT((ahead[0] - Vector2(1, 0)).norm(), 1e-12);
  EXPECT_LT((ahead[1] - Vector2(2, 0)).norm(), 1e-12);
  EXPECT_LT((ahead[2] - Vector2(2.5, 0.5)).norm(), 1e-12);
  EXPECT_LT((ahead[3] - Vector2(2.5, 1.5)).norm(), 1e-12);
}

TEST(VisitCounter, CountsWhoComesWithinFourTenthsOfAMetre) {
  VisitCounter counter({});
  counter.begin({0, 0});
  counter.route(Points{{0, 0}, {5, 0}});
  EXPECT_FALSE(counter.look({0.59, 0}));
  EXPECT_TRUE(counter.look({0.61, 0}));
  EXPECT_FALSE(counter.look({1.0, 0})) << "once is enough";
  EXPECT_FALSE(counter.look({2.0, 0.41}));
  EXPECT_TRUE(counter.look({2.0, 0.39}));
  EXPECT_EQ(counter.visited(), 2u);
}

TEST(VisitCounter, WhatWasPassedOverCountsNoMore) {
  VisitCounter counter({});
  counter.begin({0, 0});
  counter.route(Points{{0, 0}, {5, 0}});
  EXPECT_TRUE(counter.look({3, 0}));
  EXPECT_FALSE(counter.look({1, 0}));
  EXPECT_FALSE(counter.look({2, 0}));
  EXPECT_TRUE(counter.look({4, 0}));
}

TEST(VisitCounter, PlanningAnewChangesNothingOnAStraightWay) {
  VisitCounter counter({});
  counter.begin({0, 0});
  for (int i = 0; i < 200; ++i) {  // a new route every 5 cm
    const Vector2 here(0.05 * i, 0);
    counter.route(Points{here, {10, 0}});
    while (counter.look(here)) {
    }
  }
  VisitCounter once({});
  once.begin({0, 0});
  once.route(Points{{0, 0}, {10, 0}});
  drive(once, {{0, 0}, {9.95, 0}});
  EXPECT_EQ(once.visited(), 10u);
  EXPECT_EQ(counter.visited(), once.visited());
}

TEST(VisitCounter, PlanningAnewOnTheSpotBringsNoPoint) {
  VisitCounter counter({});
  counter.begin({0, 0});
  for (int i = 0; i < 1000; ++i) {
    const double angle = 0.1 * i;
    counter.route(Points{{0, 0}, {5 * std::cos(angle), 5 * std::sin(angle)}});
    counter.look({0, 0});
  }
  EXPECT_EQ(counter.visited(), 0u);
}

TEST(VisitCounter, ARobotDrivenOffItsRouteBeginsAnewWhereItIs) {
  VisitCounter counter({});
  counter.begin({0, 0});
  counter.route(Points{{0, 0}, {5, 0}});
  counter.route(Points{{0, 2}, {5, 2}});
  ASSERT_FALSE(counter.ahead().empty());
  EXPECT_LT((counter.ahead()[0] - Vector2(1, 2)).norm(), 1e-12);
  EXPECT_FALSE(counter.look({0, 2}));
}

TEST(VisitCounter, HasNothingToCountWithoutARoute) {
  VisitCounter counter({});
  EXPECT_FALSE(counter.look({0, 0}));
  counter.begin({0, 0});
  counter.route({});
  counter.route(Points{{0, 0}});
  counter.route(Points{{0, 0}, {0, 0}});
  counter.route(Points{{0, 0}, {0.5, 0}});
  EXPECT_TRUE(counter.ahead().empty()) << "a route shorter than a metre has no point";
  counter.route(Points{{0, 0}, {5, 0}});
  EXPECT_FALSE(counter.look({std::numeric_limits<double>::quiet_NaN(), 0}));
  counter.begin({0, 0});
  EXPECT_TRUE(counter.ahead().empty()) << "the route led to another target";
}

}  // namespace
}  // namespace kervan::exploration
