#include "components/observe/barn_score.hpp"

#include <gtest/gtest.h>

namespace kervan::observe {
namespace {

const BarnScoreParams world_0{.goal = {-2.25, 13.0}, .reference = 13.5923};

/// Stands for a second, then drives straight from (-2.25, 3) to 1 m before the goal in `time` from 0.1 m on.
BarnScore driven(const BarnScoreParams& params, double time) {
  BarnScore score(params);
  for (const double now : {0.0, 0.5, 1.0}) score.truth(now, {-2.25, 3.0});
  for (int i = 0; i <= 100; ++i) score.truth(2.0 + time * i / 100.0, {-2.25, 3.1 + 8.9001 * i / 100.0});
  return score;
}

TEST(BarnScore, IsTheWorkedExampleOfTheBenchmark) {
  const BarnScore score = driven(world_0, 27.2);
  EXPECT_EQ(score.outcome(), BarnOutcome::success);
  EXPECT_NEAR(score.time(), 27.2, 1e-9);
  EXPECT_NEAR(score.metric(), 0.250, 0.0005);
  EXPECT_NEAR(score.length(), 9.0, 0.001);
}

TEST(BarnScore, IsClippedToBothSides) {
  EXPECT_NEAR(driven(world_0, 10.0).metric(), 0.5, 1e-9);
  EXPECT_NEAR(driven(world_0, 90.0).metric(), 0.125, 1e-9);
}

TEST(BarnScore, AContactEndsTheRun) {
  BarnScore score(world_0);
  score.truth(0.0, {-2.25, 3.0});
  score.truth(1.0, {-2.25, 4.0});
  score.contact();
  score.truth(2.0, {-2.25, 12.5});
  EXPECT_EQ(score.outcome(), BarnOutcome::collision);
  EXPECT_EQ(score.metric(), 0.0);
  EXPECT_EQ(to_text(score.outcome()), "collision");
}

TEST(BarnScore, EndsAfterItsLimitCountedFromTheBeginning) {
  BarnScore score(world_0);
  score.truth(0.0, {-2.25, 3.0});
  score.truth(50.0, {-2.25, 3.2});
  score.truth(149.0, {-2.25, 5.0});
  EXPECT_EQ(score.outcome(), BarnOutcome::running);
  score.truth(150.0, {-2.25, 5.0});
  EXPECT_EQ(score.outcome(), BarnOutcome::timeout);
  EXPECT_EQ(score.time(), 100.0);
}

TEST(BarnScore, ARobotThatNeverBeginsEndsToo) {
  BarnScore score(world_0);
  score.truth(5.0, {-2.25, 3.0});
  score.truth(105.0, {-2.25, 3.05});
  EXPECT_EQ(score.outcome(), BarnOutcome::timeout);
  EXPECT_EQ(score.time(), 0.0);
}

TEST(BarnScore, WithoutAReferenceThereIsNoMetric) {
  BarnScoreParams params = world_0;
  params.reference = 0.0;
  EXPECT_EQ(driven(params, 20.0).metric(), 0.0);
}

}  // namespace
}  // namespace kervan::observe
