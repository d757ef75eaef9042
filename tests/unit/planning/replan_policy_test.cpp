#include "components/planning/replan_policy.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace kervan::planning {
namespace {

using namespace std::chrono_literals;
using geometry::Vector2;
using Step = ReplanPolicy::Step;

Time at(Duration since) { return Time(since); }

/// On its way along 10 m of x, planned at 0 s.
ReplanPolicy under_way(const ReplanParams& params = {}) {
  ReplanPolicy policy(params);
  policy.begin(at(0s));
  policy.planned(at(0s), {{0, 0}, {10, 0}});
  return policy;
}

TEST(ReplanPolicy, PlansOnceForAGoalAndThenLetsTheRobotDrive) {
  ReplanPolicy policy({});
  EXPECT_EQ(policy.step(at(0s)), Step::wait) << "there is no goal";
  policy.begin(at(0s));
  EXPECT_EQ(policy.step(at(0s)), Step::plan);
  policy.planned(at(0s), {{0, 0}, {10, 0}});
  for (int i = 1; i <= 100; ++i) {
    policy.move(at(i * 500ms), {0.1 * i, 0.0});
    ASSERT_EQ(policy.step(at(i * 500ms)), Step::wait) << policy.reason();
  }
}

TEST(ReplanPolicy, PlansAgainFarFromTheRoute) {
  auto policy = under_way({.deviation = 0.5});
  policy.move(at(1s), {1.0, 0.49});
  EXPECT_EQ(policy.step(at(1s)), Step::wait);
  policy.move(at(2s), {1.5, -0.52});
  EXPECT_EQ(policy.step(at(2s)), Step::plan);
  EXPECT_EQ(policy.reason(), "the robot is 0.52 m from its route");
  auto careless = under_way({.deviation = 0.0});
  careless.move(at(2s), {1.5, -50.0});
  EXPECT_EQ(careless.step(at(2s)), Step::wait);
}

TEST(ReplanPolicy, PlansAgainWhenTheRouteIsBlockedAndTakesItForNoGood) {
  auto policy = under_way();
  EXPECT_TRUE(policy.route_is_good());
  policy.blocked();
  EXPECT_FALSE(policy.route_is_good());
  EXPECT_EQ(policy.step(at(1s)), Step::plan);
  EXPECT_EQ(policy.reason(), "an obstacle is on the route");
  policy.planned(at(1s), {{1, 0}, {1, 5}, {10, 0}});
  EXPECT_TRUE(policy.route_is_good());
  EXPECT_EQ(policy.step(at(2s)), Step::wait);
}

TEST(ReplanPolicy, KeepsARouteThatIsGoodWhenAPlanFails) {
  auto policy = under_way();
  policy.ask("somebody wants it");
  policy.failed(at(1s), "no route: nowhere");
  EXPECT_TRUE(policy.route_is_good());
  policy.blocked();
  policy.failed(at(2s), "no route: nowhere");
  EXPECT_FALSE(policy.route_is_good());
}

TEST(ReplanPolicy, PlansNoMoreOftenThanItMay) {
  auto policy = under_way({.interval = 200ms});
  int plans = 0;
  // A target that jumps a hundred times a second.
  for (int i = 1; i <= 100; ++i) {
    policy.begin(at(i * 10ms));
    if (policy.step(at(i * 10ms)) != Step::plan) continue;
    ++plans;
    policy.planned(at(i * 10ms), {{0, 0}, {10, 0}});
  }
  EXPECT_EQ(plans, 5);
}

TEST(ReplanPolicy, GivesUpAfterSoManyPlansWithoutARoute) {
  ReplanPolicy policy({.retry = 1s, .tries = 3});
  policy.begin(at(0s));
  int plans = 0;
  for (int i = 0; i <= 100; ++i) {
    const Step step = policy.step(at(i * 100ms));
    if (step == Step::give_up) {
      EXPECT_EQ(i, 21) << "seen at the tick after the third, two seconds on";
      break;
    }
    if (step != Step::plan) continue;
    ++plans;
    policy.failed(at(i * 100ms), "no route: nowhere");
  }
  EXPECT_EQ(plans, 3);
  EXPECT_EQ(policy.reason(), "no route: nowhere");
}

TEST(ReplanPolicy, PlansAgainWithoutProgressAndGivesUpWhenThatDoesNotHelp) {
  auto policy = under_way({.progress = 0.3, .progress_within = 10s, .tries = 2});
  policy.move(at(5s), {1.0, 0.0});
  policy.move(at(14s), {1.2, 0.0});
  EXPECT_EQ(policy.step(at(14s)), Step::wait) << "9 s";
  policy.move(at(15s), {1.1, 0.0});
  EXPECT_EQ(policy.step(at(15s)), Step::plan);
  EXPECT_EQ(policy.reason(), "no progress: the robot came less than 0.30 m nearer in 10.0 s");
  policy.planned(at(15s), {{1.1, 0.0}, {10, 0}});
  policy.move(at(24s), {1.1, 0.0});
  EXPECT_EQ(policy.step(at(24s)), Step::wait);
  policy.move(at(25s), {1.1, 0.0});
  EXPECT_EQ(policy.step(at(25s)), Step::give_up);
}

TEST(ReplanPolicy, CountsProgressOverPlansThatChangeAllTheTime) {
  auto policy = under_way({.progress = 0.3, .progress_within = 10s, .tries = 1});
  for (int i = 1; i <= 400; ++i) {
    const double x = 0.02 * i;
    policy.move(at(i * 100ms), {x, 0.0});
    ASSERT_EQ(policy.step(at(i * 100ms)), Step::wait) << policy.reason();
    if (i % 3 == 0) policy.planned(at(i * 100ms), {{x, 0.0}, {10, 0}});
  }
}

TEST(ReplanPolicy, ForgetsFailuresOnceTheRobotHasComeOn) {
  auto policy = under_way({.progress = 0.3, .tries = 2});
  for (int i = 1; i <= 5; ++i) {
    policy.ask("somebody wants it");
    policy.failed(at(i * 10s), "no route: nowhere");
    policy.move(at(i * 10s + 5s), {i * 0.5, 0.0});
    EXPECT_NE(policy.step(at(i * 10s + 5s)), Step::give_up);
  }
}

TEST(ReplanPolicy, GivesUpWhenTheTimeForAGoalIsOver) {
  auto policy = under_way({.progress_within = 0s, .time_limit = 60s});
  EXPECT_EQ(policy.step(at(59s)), Step::wait);
  EXPECT_EQ(policy.step(at(60s)), Step::give_up);
  EXPECT_EQ(policy.reason(), "the goal was not reached within 60.0 s");
  policy.begin(at(61s));
  EXPECT_EQ(policy.step(at(61s)), Step::plan) << "another goal has its own time";
}

TEST(ReplanPolicy, WantsNothingOnceTheGoalIsReached) {
  auto policy = under_way({.time_limit = 10s});
  policy.end();
  policy.blocked();
  policy.ask("somebody wants it");
  policy.move(at(100s), {5.0, 5.0});
  EXPECT_EQ(policy.step(at(100s)), Step::wait);
}

TEST(ReplanPolicy, TakesNoNoticeOfAPositionThatIsNone) {
  auto policy = under_way({.deviation = 0.5});
  policy.move(at(1s), {std::numeric_limits<double>::quiet_NaN(), 9.0});
  EXPECT_EQ(policy.step(at(1s)), Step::wait);
}

}  // namespace
}  // namespace kervan::planning
