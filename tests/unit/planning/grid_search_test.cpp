#include "components/planning/grid_search.hpp"

#include <gtest/gtest.h>

#include "tests/planning/moving_ai.hpp"
#include "tests/planning/random_maps.hpp"

namespace kervan::planning {
namespace {

using Cell = GridSearch::Cell;

constexpr double cell_cost = 8.0 * 5741.0;

const char* name_of(SearchRule rule) {
  switch (rule) {
    case SearchRule::all_neighbours: return "all neighbours";
    case SearchRule::canonical: return "canonical";
    case SearchRule::jump_point: return "jump points";
  }
  return "";
}

/// The search finds what Dijkstra's algorithm finds, and its path costs what it says.
void expect_cheapest(const Costmap& map, GridSearch& search, Cell start, Cell goal, SearchRule rule) {
  SCOPED_TRACE(name_of(rule));
  const auto wanted = test::dijkstra(map, start, goal);
  const Reached reached = search.find(map, start, goal, rule);
  ASSERT_EQ(reached, wanted ? Reached::goal : Reached::no_path);
  if (!wanted) return;
  EXPECT_DOUBLE_EQ(search.cost(), static_cast<double>(*wanted) / cell_cost);
  ASSERT_FALSE(search.path().empty());
  EXPECT_EQ(search.path().front(), start);
  EXPECT_EQ(search.path().back(), goal);
  EXPECT_EQ(test::cost_of_steps(map, search.path()), wanted);
}

TEST(GridSearch, FindsTheCheapestWayOnRandomMapsOfUniformCosts) {
  std::mt19937 random(1);
  GridSearch search;
  for (int round = 0; round < 25; ++round) {
    const grid::CellBox box{0, 0, std::uniform_int_distribution(1, 150)(random),
                            std::uniform_int_distribution(2, 90)(random)};
    const double share = std::uniform_real_distribution(0.0, 0.45)(random);
    grid::Occupancy cells = test::random_map(random, box, share * share * 2.0);
    const Costmap map = test::bare_costmap(cells, box);
    for (int i = 0; i < 4; ++i) {
      const Cell start = test::random_free_cell(random, map), goal = test::random_free_cell(random, map);
      for (const SearchRule rule : {SearchRule::all_neighbours, SearchRule::canonical, SearchRule::jump_point})
        expect_cheapest(map, search, start, goal, rule);
    }
  }
}

TEST(GridSearch, FindsTheCheapestWayOnRandomMapsWithClearanceCosts) {
  std::mt19937 random(2);
  GridSearch search;
  for (int round = 0; round < 16; ++round) {
    const grid::CellBox box{0, 0, std::uniform_int_distribution(20, 100)(random),
                            std::uniform_int_distribution(20, 80)(random)};
    grid::Occupancy cells = test::random_map(random, box, std::uniform_real_distribution(0.0, 0.1)(random));
    Costmap map({.radius = std::uniform_real_distribution(0.0, 1.0)(random),
                 .clearance = std::uniform_real_distribution(0.5, 5.0)(random),
                 .clearance_cost = std::uniform_real_distribution(0.1, 14.0)(random)});
    map.update(cells, box);
    for (int i = 0; i < 4; ++i) {
      const Cell start = test::random_free_cell(random, map), goal = test::random_free_cell(random, map);
      for (const SearchRule rule : {SearchRule::all_neighbours, SearchRule::canonical})
        expect_cheapest(map, search, start, goal, rule);
    }
  }
}

TEST(GridSearch, JumpsAlongLinesLongerThanAWindowOfBits) {
  // Gaps at all distances from the ends of long corridors, in both directions, along rows and along columns.
  for (int gap = 1; gap <= 200; gap += 13)
    for (const bool turned : {false, true}) {
      const grid::CellBox box = turned ? grid::CellBox{0, 0, 3, 200} : grid::CellBox{0, 0, 200, 3};
      grid::Occupancy cells(1.0, -1, 1 << 20);
      cells.cover(box);
      for (int i = 0; i < 200; ++i)
        for (int k = 0; k < 3; ++k)
          *cells.place(turned ? grid::Cell{k, i} : grid::Cell{i, k}) = k == 1 && i != gap - 1 ? 100 : 0;
      const Costmap map = test::bare_costmap(cells, box);
      GridSearch search;
      for (const int from : {1, 100, 200}) {
        const Cell start = turned ? Cell{1, from} : Cell{from, 1}, goal = turned ? Cell{3, 150} : Cell{150, 3};
        expect_cheapest(map, search, start, goal, SearchRule::jump_point);
        expect_cheapest(map, search, goal, start, SearchRule::jump_point);
      }
    }
}

TEST(GridSearch, SearchesNothingForAGoalInSight) {
  std::mt19937 random(3);
  grid::Occupancy cells(1.0, -1, 1 << 20);
  const grid::CellBox box{0, 0, 150, 130};
  cells.cover(box);
  const Costmap open = test::bare_costmap(cells, box);
  GridSearch search;
  for (int i = 0; i < 50; ++i) {
    const Cell start = test::random_free_cell(random, open), goal = test::random_free_cell(random, open);
    expect_cheapest(open, search, start, goal, SearchRule::jump_point);
    EXPECT_LE(search.expanded(), 1u);
  }
  // One obstacle on the last cell but one of a line, and there is something to search for.
  *cells.place({118, 20}) = 100;
  cells.touch({118, 20, 1, 1});
  const Costmap map = test::bare_costmap(cells, box);
  expect_cheapest(map, search, {1, 21}, {120, 21}, SearchRule::jump_point);
  EXPECT_GT(search.expanded(), 1u);
}

TEST(GridSearch, CutsNoCorner) {
  const std::vector<std::string> lines = {"..#",  //
                                          "#..",  //
                                          "..."};
  grid::Occupancy cells = test::drawn_map(lines);
  const Costmap map = test::bare_costmap(cells, test::drawn_box(lines));
  GridSearch search;
  for (const SearchRule rule : {SearchRule::all_neighbours, SearchRule::canonical, SearchRule::jump_point}) {
    ASSERT_EQ(search.find(map, {1, 3}, {2, 2}, rule), Reached::goal);
    EXPECT_DOUBLE_EQ(search.cost(), 2.0) << name_of(rule) << ": a diagonal would pass the corner of the left obstacle";
  }
}

TEST(GridSearch, StandsWhereItIs) {
  grid::Occupancy cells = test::drawn_map({"..."});
  const Costmap map = test::bare_costmap(cells, {0, 0, 3, 1});
  GridSearch search;
  for (const SearchRule rule : {SearchRule::all_neighbours, SearchRule::canonical, SearchRule::jump_point}) {
    ASSERT_EQ(search.find(map, {2, 1}, {2, 1}, rule), Reached::goal);
    EXPECT_EQ(search.cost(), 0.0);
    EXPECT_EQ(search.path(), std::vector<Cell>{Cell({2, 1})});
  }
}

TEST(GridSearch, KnowsWhatItCameToWhereThereIsNoWay) {
  const std::vector<std::string> lines = {"..#..", "..#..", "..#.."};
  grid::Occupancy cells = test::drawn_map(lines);
  const Costmap map = test::bare_costmap(cells, test::drawn_box(lines));
  GridSearch search;
  for (const SearchRule rule : {SearchRule::jump_point, SearchRule::canonical, SearchRule::all_neighbours})
    ASSERT_EQ(search.find(map, {1, 1}, {5, 3}, rule), Reached::no_path) << name_of(rule);
  EXPECT_EQ(search.expanded(), 6u);
  for (int x = 1; x <= 5; ++x) EXPECT_EQ(search.came_to(map.index(x, 2)), x <= 2) << x;
}

TEST(GridSearch, GivesUpAfterAsManyCellsAsItMay) {
  grid::Occupancy cells = test::drawn_map(std::vector<std::string>(30, std::string(30, '.')));
  *cells.place({15, 15}) = 100;
  const Costmap map = test::bare_costmap(cells, {0, 0, 30, 30});
  GridSearch search;
  ASSERT_EQ(search.find(map, {1, 1}, {30, 30}, SearchRule::all_neighbours), Reached::goal);
  const std::size_t needed = search.expanded();
  EXPECT_EQ(search.find(map, {1, 1}, {30, 30}, SearchRule::all_neighbours, needed), Reached::goal);
  EXPECT_EQ(search.find(map, {1, 1}, {30, 30}, SearchRule::all_neighbours, needed - 1), Reached::gave_up);
  EXPECT_EQ(search.find(map, {1, 1}, {30, 30}, SearchRule::jump_point, 1), Reached::gave_up);
}

TEST(GridSearch, FindsTheSameWhenItsLabelsHaveGoneRoundOnce) {
  const std::vector<std::string> lines = {"....", ".##.", "...."};
  grid::Occupancy cells = test::drawn_map(lines);
  const Costmap map = test::bare_costmap(cells, test::drawn_box(lines));
  GridSearch search;
  for (int i = 0; i < 66'000; ++i) {
    ASSERT_EQ(search.find(map, {1, 2}, {4, 2}, SearchRule::canonical), Reached::goal);
    ASSERT_DOUBLE_EQ(search.cost(), 5.0) << "search " << i;
  }
}

}  // namespace
}  // namespace kervan::planning
