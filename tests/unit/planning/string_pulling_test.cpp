#include "components/planning/string_pulling.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "components/planning/line_walk.hpp"
#include "tests/planning/moving_ai.hpp"
#include "tests/planning/random_maps.hpp"

namespace kervan::planning {
namespace {

using geometry::Vector2;

Vector2 middle_of(const GridSearch::Cell& cell) { return {cell.x + 0.5, cell.y + 0.5}; }

double length_of(const std::vector<Vector2>& points) {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

/// Cells, from a point to the nearest obstacle: the cells of the map that are above 50 per cent.
double to_obstacle(const grid::Occupancy& cells, const grid::CellBox& box, const Vector2& point) {
  double nearest = 1e9;
  for (int y = 0; y < box.rows; ++y)
    for (int x = 0; x < box.columns; ++x)
      if (cells.at({x, y}) > 50) {
        const double dx = std::max({x + 1.0 - point.x(), point.x() - (x + 2.0), 0.0}),
                     dy = std::max({y + 1.0 - point.y(), point.y() - (y + 2.0), 0.0});
        nearest = std::min(nearest, std::hypot(dx, dy));
      }
  return nearest;
}

TEST(WalkLine, TouchesEveryCellThatTheLineGoesThrough) {
  std::mt19937 random(1);
  const auto number = [&] { return std::uniform_real_distribution(0.0, 12.0)(random); };
  for (int round = 0; round < 300; ++round) {
    const Vector2 a(number(), number()), b(number(), number());
    std::vector<std::pair<int, int>> touched;
    double shares = 0.0;
    EXPECT_TRUE(walk_line(a, b, [&](int x, int y, double share) {
      touched.emplace_back(x, y);
      shares += share;
      return true;
    }));
    EXPECT_NEAR(shares, 1.0, 1e-9);
    for (int i = 0; i <= 500; ++i) {
      const Vector2 at = a + i / 500.0 * (b - a);
      const std::pair cell{static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y()))};
      ASSERT_NE(std::find(touched.begin(), touched.end(), cell), touched.end());
    }
  }
}

TEST(WalkLine, TouchesBothCellsBesideACorner) {
  std::vector<std::pair<int, int>> touched;
  walk_line({0.5, 0.5}, {2.5, 2.5}, [&](int x, int y, double) {
    touched.emplace_back(x, y);
    return true;
  });
  const std::vector<std::pair<int, int>> wanted = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {2, 1}, {1, 2}, {2, 2}};
  EXPECT_EQ(touched, wanted);
}

TEST(StringPuller, DrawsOneLineWhereNothingIsInTheWay) {
  grid::Occupancy cells = test::drawn_map(std::vector<std::string>(20, std::string(40, '.')));
  const Costmap map = test::bare_costmap(cells, {0, 0, 40, 20});
  GridSearch search;
  ASSERT_EQ(search.find(map, {2, 3}, {38, 17}, SearchRule::canonical), Reached::goal);
  StringPuller string;
  const auto& points = string.pull(map, search.path(), {2.2, 3.9}, {38.7, 17.1});
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0], Vector2(2.2, 3.9));
  EXPECT_EQ(points[1], Vector2(38.7, 17.1));
}

TEST(StringPuller, TurnsTightRoundACorner) {
  std::vector<std::string> lines(20, std::string(20, '.'));
  for (int row = 8; row < 20; ++row) lines[static_cast<std::size_t>(row)][10] = '#';
  grid::Occupancy cells = test::drawn_map(lines);
  const Costmap map = test::bare_costmap(cells, test::drawn_box(lines));
  GridSearch search;
  ASSERT_EQ(search.find(map, {2, 2}, {19, 2}, SearchRule::canonical), Reached::goal);
  StringPuller string;
  const auto& points = string.pull(map, search.path(), {2.5, 2.5}, {19.5, 2.5});
  // Round the corners (11, 13) and (12, 13) of the wall.
  const double shortest = std::hypot(8.5, 10.5) + 1.0 + std::hypot(7.5, 10.5);
  EXPECT_GE(length_of(points), shortest - 1e-9);
  EXPECT_LE(length_of(points), 1.01 * shortest);
}

TEST(StringPuller, NeverTouchesWhatIsBlockedAndNeverGrowsLonger) {
  std::mt19937 random(2);
  GridSearch search;
  StringPuller string;
  const grid::CellBox box{0, 0, 60, 50};
  for (int round = 0; round < 60; ++round) {
    const double radius = round % 3 == 0 ? 0.0 : std::uniform_real_distribution(0.5, 2.5)(random);
    grid::Occupancy cells = test::random_map(random, box, radius == 0.0 ? 0.2 : 0.02);
    Costmap map({.radius = radius, .clearance = 0.0});
    map.update(cells, box);
    const GridSearch::Cell start = test::random_free_cell(random, map), goal = test::random_free_cell(random, map);
    if (search.find(map, start, goal, SearchRule::jump_point) != Reached::goal) continue;
    const auto& points = string.pull(map, search.path(), middle_of(start), middle_of(goal));
    EXPECT_LE(length_of(points), search.cost() + 1e-6);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const int samples = 1 + static_cast<int>((points[i] - points[i - 1]).norm() / 0.2);
      for (int k = 0; k <= samples; ++k) {
        const Vector2 at = points[i - 1] + static_cast<double>(k) / samples * (points[i] - points[i - 1]);
        ASSERT_FALSE(map.blocked(map.index(static_cast<int>(at.x()), static_cast<int>(at.y())))) << at.transpose();
        ASSERT_GE(to_obstacle(cells, box, at), radius - std::sqrt(0.5)) << at.transpose();
      }
    }
  }
}

TEST(StringPuller, TakesNoShortCutThatCostsMore) {
  std::mt19937 random(3);
  GridSearch search;
  StringPuller string;
  const grid::CellBox box{0, 0, 60, 50};
  int turned = 0;
  for (int round = 0; round < 40; ++round) {
    grid::Occupancy cells = test::random_map(random, box, 0.01);
    Costmap map({.radius = 0.8, .clearance = 4.0, .clearance_cost = 5.0});
    map.update(cells, box);
    const GridSearch::Cell start = test::random_free_cell(random, map), goal = test::random_free_cell(random, map);
    if (search.find(map, start, goal, SearchRule::canonical) != Reached::goal) continue;
    double before = 0.0, after = 0.0;
    const auto& path = search.path();
    for (std::size_t i = 1; i < path.size(); ++i) before += line_cost(map, middle_of(path[i - 1]), middle_of(path[i]));
    const auto& points = string.pull(map, path, middle_of(start), middle_of(goal));
    for (std::size_t i = 1; i < points.size(); ++i) after += line_cost(map, points[i - 1], points[i]);
    EXPECT_LE(after, before + 1e-6);
    turned += points.size() > 2 ? 1 : 0;
  }
  EXPECT_GT(turned, 10) << "with costs the straight line is not always the cheapest";
}

}  // namespace
}  // namespace kervan::planning
