#include "components/planning/grid_planner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/planning/moving_ai.hpp"

namespace kervan::planning {
namespace {

using geometry::Vector2;

/// Cells of 1 m; point (0.5, 0.5) is the middle of the lower left one.
class GridPlannerTest : public testing::Test {
 protected:
  void draw(const std::vector<std::string>& lines, const GridPlannerParams& params) {
    cells_ = test::drawn_map(lines);
    planner_.emplace(params);
    planner_->update(cells_, test::drawn_box(lines));
  }
  void draw(const std::vector<std::string>& lines) { draw(lines, {.costs = {.radius = 0.0, .clearance = 0.0}}); }
  const Plan& plan(const Query& query) {
    planner_->plan(query, plan_);
    return plan_;
  }

  grid::Occupancy cells_{1.0, -1, 1 << 20};
  std::optional<GridPlanner> planner_;
  Plan plan_;
};

void expect_refused(const Plan& plan, Outcome outcome, const std::string& why) {
  EXPECT_EQ(plan.outcome, outcome);
  EXPECT_EQ(plan.why, why);
  EXPECT_TRUE(plan.points.empty());
  EXPECT_EQ(plan.length, 0.0);
}

TEST_F(GridPlannerTest, BeginsAndEndsExactlyWhereItIsTold) {
  draw({"......", ".####.", "......"});
  const Plan& found = plan({.start = {0.7, 0.3}, .goal = {1.6, 2.8}});
  EXPECT_EQ(found.outcome, Outcome::found);
  EXPECT_EQ(found.why, "");
  EXPECT_EQ(found.points.front(), Vector2(0.7, 0.3));
  EXPECT_EQ(found.points.back(), Vector2(1.6, 2.8));
  EXPECT_GT(found.points.size(), 2u);
  EXPECT_GT(found.length, (Vector2(1.6, 2.8) - Vector2(0.7, 0.3)).norm());
  EXPECT_EQ(found.start_moved, 0.0);
  EXPECT_EQ(found.goal_moved, 0.0);
  EXPECT_GT(found.cost, 0.0);
}

TEST_F(GridPlannerTest, GivesTheMiddlesOfCellsWhereNothingIsPulled) {
  draw({"....", "....", "...."}, {.costs = {.radius = 0.0, .clearance = 0.0}, .any_angle = false});
  const Plan& found = plan({.start = {0.5, 0.5}, .goal = {3.5, 1.5}});
  ASSERT_EQ(found.points.size(), 4u);
  EXPECT_EQ(found.points[1], Vector2(1.5, 1.5)) << "diagonal first";
  EXPECT_EQ(found.points[2], Vector2(2.5, 1.5));
  EXPECT_NEAR(found.cost, 2.0 + std::sqrt(2.0), 1e-7);
}

TEST_F(GridPlannerTest, SaysWhenThereIsNoWay) {
  draw({"..#..", "..#..", "..#.."});
  expect_refused(plan({.start = {0.5, 0.5}, .goal = {4.5, 0.5}}), Outcome::no_path,
                 "no route: no free way leads from the robot to the goal");
}

TEST_F(GridPlannerTest, EndsAtTheNearestPlaceThatCanBeReached) {
  draw({"..#..", "..#..", "..#.."});
  const Plan& found = plan({.start = {0.5, 0.5}, .goal = {4.5, 1.5}, .tolerance = 3.5});
  EXPECT_EQ(found.outcome, Outcome::found);
  EXPECT_EQ(found.points.back(), Vector2(1.5, 1.5));
  EXPECT_DOUBLE_EQ(found.goal_moved, 3.0);
  EXPECT_EQ(plan({.start = {0.5, 0.5}, .goal = {4.5, 1.5}, .tolerance = 2.9}).outcome, Outcome::no_path);
}

TEST_F(GridPlannerTest, EndsBesideAnObstacleThatTheGoalIsIn) {
  draw({".....", ".###.", ".###.", ".###.", "....."});
  const Plan& found = plan({.start = {0.5, 0.5}, .goal = {3.4, 2.5}, .tolerance = 1.2});
  EXPECT_EQ(found.outcome, Outcome::found);
  EXPECT_EQ(found.points.back(), Vector2(4.5, 2.5));
  EXPECT_DOUBLE_EQ(found.goal_moved, 1.1);
  expect_refused(plan({.start = {0.5, 0.5}, .goal = {3.4, 2.5}, .tolerance = 1.0}), Outcome::goal_occupied,
                 "no route: the goal is too near to an obstacle, and so is all within its tolerance");
}

TEST_F(GridPlannerTest, SaysWhenWhatIsFreeBesideTheGoalCannotBeReached) {
  draw({"..#..", "..#.#", "..#.."});
  expect_refused(plan({.start = {0.5, 0.5}, .goal = {4.5, 1.5}, .tolerance = 1.5}), Outcome::goal_occupied,
                 "no route: the goal is too near to an obstacle, and what is free within its tolerance cannot be "
                 "reached");
}

TEST_F(GridPlannerTest, EscapesToTheNearestFreePlaceIfItMay) {
  draw({".....", ".....", "#....", ".....", "....."}, {.costs = {.radius = 1.2, .clearance = 0.0}});
  const Query query{.start = {1.4, 2.6}, .goal = {4.5, 4.5}};
  expect_refused(plan(query), Outcome::start_occupied,
                 "no route: the robot is too near to an obstacle, and no free place is within its reach");
  Query escaping = query;
  escaping.escape = 1.5;
  const Plan& found = plan(escaping);
  EXPECT_EQ(found.outcome, Outcome::found);
  EXPECT_EQ(found.points[0], query.start);
  EXPECT_EQ(found.points[1], Vector2(2.5, 2.5));
  EXPECT_DOUBLE_EQ(found.start_moved, std::hypot(1.1, 0.1));
}

TEST_F(GridPlannerTest, DoesNotEscapeThroughAWall) {
  draw({"..#..", "#.#..", "..#.."}, {.costs = {.radius = 0.6, .clearance = 0.0}});
  // Nothing is free left of the wall.
  EXPECT_EQ(plan({.start = {1.5, 1.5}, .goal = {4.5, 1.5}, .escape = 5.0}).outcome, Outcome::start_occupied);
}

TEST_F(GridPlannerTest, LeavesAnObstacleThatTheMapHasAroundIt) {
  draw({"......", ".##...", "......"});
  const Plan& found = plan({.start = {2.4, 1.5}, .goal = {5.5, 1.5}, .escape = 2.0});
  EXPECT_EQ(found.outcome, Outcome::found);
  EXPECT_EQ(found.points[1], Vector2(2.5, 0.5));
}

TEST_F(GridPlannerTest, SaysWhatIsOutsideOfTheMap) {
  draw({"...", "..."});
  expect_refused(plan({.start = {-0.1, 0.5}, .goal = {1.5, 0.5}}), Outcome::start_outside,
                 "no route: the robot is outside of the map");
  expect_refused(plan({.start = {0.5, 0.5}, .goal = {1.5, 2.1}}), Outcome::goal_outside,
                 "no route: the goal is outside of the map");
  EXPECT_EQ(plan({.start = {0.5, 0.5}, .goal = {1e300, 0.5}}).outcome, Outcome::goal_outside);
}

TEST_F(GridPlannerTest, SaysWhatIsNoNumber) {
  draw({"...", "..."});
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  expect_refused(plan({.start = {nan, 0.5}, .goal = {1.5, 0.5}}), Outcome::not_finite,
                 "no route: where the robot is has a coordinate that is no number");
  expect_refused(plan({.start = {0.5, 0.5}, .goal = {1.5, infinity}}), Outcome::not_finite,
                 "no route: the goal has a coordinate that is no number");
}

TEST_F(GridPlannerTest, FindsNothingOnAMapWithoutCells) {
  GridPlanner planner({});
  planner.plan({.start = {0.5, 0.5}, .goal = {1.5, 0.5}}, plan_);
  EXPECT_EQ(plan_.outcome, Outcome::start_outside);
}

TEST_F(GridPlannerTest, GivesUpWhenItHasLookedAtAsManyCellsAsItMay) {
  draw({"..#..", "..#..", "....."});
  Query query{.start = {0.5, 1.5}, .goal = {4.5, 1.5}};
  ASSERT_EQ(plan(query).outcome, Outcome::found);
  const std::size_t needed = plan_.expanded;
  query.most_expanded = needed;
  EXPECT_EQ(plan(query).outcome, Outcome::found);
  query.most_expanded = needed - 1;
  expect_refused(plan(query), Outcome::timeout,
                 "no route: the search was given up, it looked at as many cells as it may");
}

TEST_F(GridPlannerTest, StaysAwayFromObstaclesWhereThatCostsLittle) {
  std::vector<std::string> lines(30, std::string(40, '.'));
  lines[15] = "...................###..................";
  GridPlannerParams params{.costs = {.radius = 1.0, .clearance = 6.0, .clearance_cost = 6.0}};
  draw(lines, params);
  const Query query{.start = {2.5, 14.5}, .goal = {37.5, 14.5}};
  const double dear = plan(query).length;
  params.costs.clearance_cost = 0.0;
  draw(lines, params);
  EXPECT_LT(plan(query).length, dear - 0.1);
}

TEST_F(GridPlannerTest, FollowsTheMap) {
  draw({".....", ".....", "....."});
  const Query query{.start = {0.5, 1.5}, .goal = {4.5, 1.5}};
  EXPECT_DOUBLE_EQ(plan(query).length, 4.0);
  for (int y = 0; y < 3; ++y) *cells_.place({2, y}) = 100;
  cells_.touch({2, 0, 1, 3});
  planner_->update(cells_, {0, 0, 5, 3});
  EXPECT_EQ(plan(query).outcome, Outcome::no_path);
}

TEST_F(GridPlannerTest, SearchesByEveryRuleAsWell) {
  for (const SearchChoice search :
       {SearchChoice::automatic, SearchChoice::all_neighbours, SearchChoice::canonical, SearchChoice::jump_point}) {
    draw({"......", ".####.", "......"}, {.costs = {.radius = 0.0, .clearance = 0.0}, .search = search});
    const Plan& found = plan({.start = {1.5, 0.5}, .goal = {3.5, 2.5}});
    EXPECT_EQ(found.outcome, Outcome::found);
    EXPECT_NEAR(found.cost, 6.0, 1e-12);
  }
}

}  // namespace
}  // namespace kervan::planning
