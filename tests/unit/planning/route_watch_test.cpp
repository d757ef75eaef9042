#include "components/planning/route_watch.hpp"

#include <gtest/gtest.h>

namespace kervan::planning {
namespace {

/// 6 x 2 m of free cells of 0.1 m, and a robot of 0.2 m radius that likes 0.2 m more.
class RouteWatchTest : public testing::Test {
 protected:
  grid::CellBox box{0, 0, 60, 20};
  grid::Occupancy cells{0.1, -1, 100'000};
  Costmap map{{.radius = 0.2, .clearance = 0.2, .clearance_cost = 4.0}};
  RouteWatch watch;

  void SetUp() override {
    ASSERT_NE(cells.cover(box), grid::Growth::refused);
    for (int y = 0; y < box.rows; ++y)
      for (int x = 0; x < box.columns; ++x) *cells.place({x, y}) = 0;
    cells.touch(box);
    map.update(cells, box);
    watch.watch(map, {{0.5, 1.0}, {5.5, 1.0}});
  }

  RouteChange put(int x, int y, double along = 0.0, double tolerated = 0.2) {
    *cells.place({x, y}) = 100;
    cells.touch({x, y, 1, 1});
    map.update(cells, box);
    return watch.look(map, along, tolerated);
  }
};

TEST_F(RouteWatchTest, SeesNothingWhereNothingHasChanged) {
  EXPECT_EQ(watch.look(map, 0.0, 0.0), RouteChange::none);
  EXPECT_EQ(put(30, 19), RouteChange::none) << "0.9 m beside the route";
}

TEST_F(RouteWatchTest, SeesAnObstacleOnTheRouteAhead) {
  EXPECT_EQ(put(30, 9), RouteChange::blocked);
  EXPECT_EQ(watch.look(map, 3.5, 0.2), RouteChange::none) << "the robot is past it";
}

TEST_F(RouteWatchTest, SeesThatTheRouteHasBecomeDearer) {
  EXPECT_EQ(put(30, 13, 0.0, 10.0), RouteChange::none);
  EXPECT_EQ(watch.look(map, 0.0, 0.01), RouteChange::dearer);
  EXPECT_EQ(watch.look(map, 4.0, 0.01), RouteChange::none);
}

TEST_F(RouteWatchTest, LetsARobotEscapeFromWhereItWasTooNear) {
  put(5, 9);
  watch.watch(map, {{0.55, 1.1}, {5.5, 1.0}});
  EXPECT_EQ(watch.look(map, 0.0, 0.0), RouteChange::none);
}

TEST_F(RouteWatchTest, KnowsItsCellsInAMapThatHasGrown) {
  const grid::CellBox larger{-20, -20, 100, 60};
  ASSERT_NE(cells.cover(larger), grid::Growth::refused);
  map.update(cells, larger);
  EXPECT_EQ(watch.look(map, 0.0, 0.0), RouteChange::none);
  *cells.place({30, 9}) = 100;
  cells.touch({30, 9, 1, 1});
  map.update(cells, larger);
  EXPECT_EQ(watch.look(map, 0.0, 0.0), RouteChange::blocked);
}

}  // namespace
}  // namespace kervan::planning
