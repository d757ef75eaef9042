#include "components/planning/ompl_planner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "components/planning/line_walk.hpp"
#include "components/planning/ompl_budget.hpp"
#include "tests/planning/moving_ai.hpp"
#include "tests/planning/random_maps.hpp"

namespace kervan::planning {
namespace {

using geometry::Vector2;

constexpr std::size_t enough = 500'000;  // steps

std::string name_of(OmplAlgorithm algorithm) { return ompl_names()[static_cast<std::size_t>(algorithm)]; }

std::vector<OmplAlgorithm> all_algorithms() {
  std::vector<OmplAlgorithm> all;
  for (std::size_t i = 0; i < ompl_names().size(); ++i) all.push_back(static_cast<OmplAlgorithm>(i));
  return all;
}

/// A room with two walls, each open at another end.
std::vector<std::string> two_walls() {
  return {"....................", "....................", "......#.............", "......#......#......",
          "......#......#......", "......#......#......", "......#......#......", "......#......#......",
          "......#......#......", "......#......#......", "......#.............", "......#............."};
}

class OmplPlannerTest : public testing::Test {
 protected:
  void draw(const std::vector<std::string>& lines, OmplParams params) {
    cells_ = test::drawn_map(lines);
    params.costs = {.radius = 0.0, .clearance = 0.0};
    planner_.emplace(params);
    planner_->update(cells_, test::drawn_box(lines));
  }
  const Plan& plan(Query query) {
    if (query.most_expanded == 0) query.most_expanded = enough;
    planner_->plan(query, plan_);
    return plan_;
  }

  /// No line of the route touches a blocked cell, and its length is what it says.
  void expect_free() {
    double length = 0.0;
    const Costmap& map = planner_->costmap();
    for (std::size_t i = 1; i < plan_.points.size(); ++i) {
      length += (plan_.points[i] - plan_.points[i - 1]).norm();
      EXPECT_TRUE(walk_line(map.to_cells(plan_.points[i - 1]), map.to_cells(plan_.points[i]),
                            [&](int x, int y, double) { return !map.blocked(map.index(x, y)); }))
          << "line " << i;
    }
    EXPECT_DOUBLE_EQ(length, plan_.length);
  }

  grid::Occupancy cells_{1.0, -1, 1 << 20};
  std::optional<OmplPlanner> planner_;
  Plan plan_;
};

const Query across{.start = {1.3, 0.7}, .goal = {18.6, 11.2}};

TEST_F(OmplPlannerTest, EveryPlannerFindsAFreeWayRoundWalls) {
  for (const OmplAlgorithm algorithm : all_algorithms()) {
    SCOPED_TRACE(name_of(algorithm));
    draw(two_walls(), {.algorithm = algorithm});
    const Plan& found = plan(across);
    ASSERT_EQ(found.outcome, Outcome::found) << found.why;
    EXPECT_EQ(found.points.front(), across.start);
    EXPECT_EQ(found.points.back(), across.goal);
    EXPECT_GT(found.length, 23.1) << "no way is as short";
    EXPECT_LT(found.length, 40.0);
    EXPECT_TRUE(found.headings.empty());
    expect_free();
  }
}

TEST_F(OmplPlannerTest, AnswersTheSameWhateverWasAskedBefore) {
  for (const OmplAlgorithm algorithm : all_algorithms()) {
    if (!repeatable(algorithm)) continue;
    SCOPED_TRACE(name_of(algorithm));
    const OmplParams params{.algorithm = algorithm, .seed = 7};
    Query query = across;
    query.most_expanded = 300'000;
    draw(two_walls(), params);
    plan({.start = {3.0, 3.0}, .goal = {1.0, 9.0}, .most_expanded = 1000});
    const Plan first = plan(query);
    draw(two_walls(), params);
    const Plan& second = plan(query);
    EXPECT_EQ(first.outcome, second.outcome);
    EXPECT_EQ(first.points, second.points);
    EXPECT_EQ(first.expanded, second.expanded);
  }
}

TEST_F(OmplPlannerTest, AnotherSeedIsAnotherWay) {
  draw(two_walls(), {.algorithm = OmplAlgorithm::rrt, .simplify = false, .seed = 1});
  const Plan first = plan(across);
  draw(two_walls(), {.algorithm = OmplAlgorithm::rrt, .simplify = false, .seed = 2});
  EXPECT_NE(first.points, plan(across).points);
}

TEST_F(OmplPlannerTest, KeepsToItsBudgetWhereThereIsNoWay) {
  // What a planner asks for after the end of its budget is 10 ms worth of steps at most, and the one that ended it.
  constexpr std::size_t budget = 200'000,
                        most = budget + static_cast<std::size_t>(OmplBudget::grace * OmplBudget::steps_per_second);
  std::mt19937 random(3);
  cells_ = test::random_map(random, {0, 0, 120, 120}, 0.35);
  for (const OmplAlgorithm algorithm : all_algorithms()) {
    SCOPED_TRACE(name_of(algorithm));
    OmplPlanner planner({.costs = {.radius = 0.0, .clearance = 0.0}, .algorithm = algorithm});
    *cells_.place({10, 10}) = *cells_.place({110, 110}) = 0;
    for (int x = 0; x < 120; ++x) *cells_.place({x, 60}) = 100;
    planner.update(cells_, {0, 0, 120, 120});
    planner.plan({.start = {10.5, 10.5}, .goal = {110.5, 110.5}, .most_expanded = budget}, plan_);
    EXPECT_EQ(plan_.outcome, Outcome::timeout);
    EXPECT_EQ(plan_.why, "no route: the planner found no way in its time");
    EXPECT_TRUE(plan_.points.empty());
    EXPECT_LT(plan_.expanded, most + 2000);
  }
}

TEST_F(OmplPlannerTest, SimplifiedWaysAreShorter) {
  for (const OmplAlgorithm algorithm : {OmplAlgorithm::rrt_connect, OmplAlgorithm::rrt, OmplAlgorithm::est}) {
    SCOPED_TRACE(name_of(algorithm));
    draw(two_walls(), {.algorithm = algorithm, .simplify = false});
    const double rough = plan(across).length;
    draw(two_walls(), {.algorithm = algorithm});
    EXPECT_LT(plan(across).length, 0.98 * rough);
  }
}

TEST_F(OmplPlannerTest, GoesOnMakingWaysShorterOnlyIfThePlannerCan) {
  draw(two_walls(), {.algorithm = OmplAlgorithm::prm_star});
  EXPECT_GT(plan(across).expanded, enough / 2);
  EXPECT_LT(plan_.length, 23.3) << "near the shortest";
  draw(two_walls(), {.algorithm = OmplAlgorithm::rrt_connect});
  EXPECT_LT(plan(across).expanded, enough / 2);
}

TEST_F(OmplPlannerTest, DoesNotStepOverThinWalls) {
  // A wall of one cell across a map of 400: OMPL's own test would look at points four cells apart.
  std::vector<std::string> lines(400, std::string(400, '.'));
  for (std::string& line : lines) line[200] = '#';
  draw(lines, {.algorithm = OmplAlgorithm::rrt_connect});
  EXPECT_EQ(plan({.start = {20.5, 20.5}, .goal = {380.5, 380.5}, .most_expanded = 200'000}).outcome, Outcome::timeout);
}

TEST_F(OmplPlannerTest, TurnsNoTighterThanItMay) {
  using enum OmplAlgorithm;
  const std::map<OmplSpace, std::vector<OmplAlgorithm>> some = {
      {OmplSpace::dubins, {rrt, rrt_star, est}}, {OmplSpace::reeds_shepp, {prm_star, rrt_connect, rrt_star, bit_star}}};
  for (const auto& [space, algorithms] : some)
    for (const OmplAlgorithm algorithm : algorithms) {
      ASSERT_TRUE(may_plan_in(algorithm, space));
      SCOPED_TRACE(name_of(algorithm) + (space == OmplSpace::dubins ? ", dubins" : ", reeds_shepp"));
      draw(two_walls(), {.algorithm = algorithm, .space = space, .turning_radius = 1.5});
      Query query = across;
      query.start_heading = 3.0;
      query.goal_heading = 1.0;
      query.most_expanded = 3 * enough;
      const Plan& found = plan(query);
      ASSERT_EQ(found.outcome, Outcome::found) << found.why;
      expect_free();
      ASSERT_EQ(found.headings.size(), found.points.size());
      EXPECT_NEAR(found.headings.front(), 3.0, 1e-9);
      EXPECT_NEAR(found.headings.back(), 1.0, 1e-9);
      bool backwards = false;
      for (std::size_t i = 1; i < found.points.size(); ++i) {
        const Vector2 step = found.points[i] - found.points[i - 1];
        if (step.norm() < 0.02) continue;  // what is left of a curve may be smaller than its error
        const double turned = std::abs(geometry::wrap_angle(found.headings[i] - found.headings[i - 1]));
        EXPECT_LT(turned * 1.5, 1.02 * step.norm() + 0.01) << "corner " << i;
        backwards = backwards || step.dot(geometry::heading(found.headings[i])) < 0.0;
      }
      if (space == OmplSpace::dubins) {
        EXPECT_FALSE(backwards);
      }
    }
}

TEST_F(OmplPlannerTest, TakesAnyHeadingAtTheGoalUnlessOneIsAskedFor) {
  draw(std::vector<std::string>(20, std::string(20, '.')),
       {.algorithm = OmplAlgorithm::rrt_connect, .space = OmplSpace::dubins, .turning_radius = 2.0});
  Query query{.start = {3.0, 10.0}, .goal = {17.0, 10.0}};
  EXPECT_LT(plan(query).length, 15.0);
  query.goal_heading = std::numbers::pi;
  EXPECT_GT(plan(query).length, 17.0) << "it has to turn round";
}

TEST_F(OmplPlannerTest, CountsTurningInSe2) {
  draw(two_walls(), {.algorithm = OmplAlgorithm::rrt_connect, .space = OmplSpace::se2});
  Query query = across;
  query.goal_heading = -1.5;
  ASSERT_EQ(plan(query).outcome, Outcome::found);
  EXPECT_NEAR(plan_.headings.back(), -1.5, 1e-9);
  expect_free();
}

TEST_F(OmplPlannerTest, SaysWhyThereIsNoPlan) {
  draw({"..#..", "..#..", "..#.."}, {});
  const auto refused = [&](const Query& query) { return std::string(plan(query).why); };
  EXPECT_EQ(refused({.start = {0.5, 0.5}, .goal = {2.5, 0.5}}),
            "no route: the goal is too near to an obstacle, and so is all within its tolerance");
  EXPECT_EQ(refused({.start = {2.5, 0.5}, .goal = {0.5, 0.5}}),
            "no route: the robot is too near to an obstacle, and no free place is within its reach");
  EXPECT_EQ(refused({.start = {0.5, 0.5}, .goal = {9.5, 0.5}}), "no route: the goal is outside of the map");
  EXPECT_EQ(refused({.start = {0.5, 0.5}, .goal = {NAN, 0.5}}),
            "no route: the goal has a coordinate that is no number");
}

TEST_F(OmplPlannerTest, EndsBesideAGoalInAnObstacleAndEscapesFromOne) {
  draw({".....", ".###.", "....."}, {.algorithm = OmplAlgorithm::rrt_connect});
  plan({.start = {2.5, 1.9}, .goal = {1.5, 1.2}, .escape = 1.0, .tolerance = 1.0});
  ASSERT_EQ(plan_.outcome, Outcome::found) << plan_.why;
  EXPECT_EQ(plan_.points.front(), Vector2(2.5, 1.9));
  EXPECT_EQ(plan_.points[1], Vector2(2.5, 2.5));
  EXPECT_EQ(plan_.points.back(), Vector2(1.5, 0.5));
  EXPECT_NEAR(plan_.start_moved, 0.6, 1e-12);
  EXPECT_NEAR(plan_.goal_moved, 0.7, 1e-12);
}

TEST_F(OmplPlannerTest, GivesUpSoonWhenCancelled) {
  for (const OmplAlgorithm algorithm : all_algorithms()) {
    SCOPED_TRACE(name_of(algorithm));
    draw(two_walls(), {.algorithm = algorithm});
    int asked = 0;
    planner_->set_cancelled([&] { return ++asked == 5; });
    EXPECT_EQ(plan(across).why, "no route: the plan was cancelled");
    EXPECT_EQ(plan_.outcome, Outcome::timeout);
    EXPECT_EQ(asked, 5) << "once is enough";
    EXPECT_LT(plan_.expanded, 1000 + static_cast<std::size_t>(OmplBudget::grace * OmplBudget::steps_per_second));
  }
}

TEST_F(OmplPlannerTest, StaysWhereItIs) {
  draw(two_walls(), {.algorithm = OmplAlgorithm::rrt_connect});
  EXPECT_EQ(plan({.start = {1.5, 1.5}, .goal = {1.5, 1.5}}).outcome, Outcome::found);
  EXPECT_EQ(plan_.length, 0.0);
}

}  // namespace
}  // namespace kervan::planning
