#include "deploy/supervisor/restart_budget.hpp"

#include <gtest/gtest.h>

namespace kervan::supervisor {
namespace {

using namespace std::chrono_literals;

const SteadyTime start{};
constexpr Duration never_active{};

TEST(RestartBudget, WaitsTwiceAsLongEachTimeUpToALimit) {
  RestartBudget budget({.max = 100, .window = 30s});
  const Duration expected[] = {100ms, 200ms, 400ms, 800ms, 1600ms, 3200ms, 5s, 5s};
  for (const Duration delay : expected) EXPECT_EQ(budget.spend(start, never_active), delay);
}

TEST(RestartBudget, BeginsAgainWithAContainerThatWasActiveForASecond) {
  RestartBudget budget({.max = 100, .window = 30s});
  budget.spend(start, never_active);
  EXPECT_EQ(budget.spend(start, 999ms), 200ms);
  EXPECT_EQ(budget.spend(start, 1s), 100ms);
  EXPECT_EQ(budget.spend(start, never_active), 200ms);
}

TEST(RestartBudget, IsSpentAfterTheLargestNumberWithinTheWindow) {
  RestartBudget budget({.max = 5, .window = 30s});
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(budget.spend(start + i * 1s, never_active)) << i;
  EXPECT_EQ(budget.recent(), 5);
  EXPECT_FALSE(budget.spend(start + 30s, never_active));
}

TEST(RestartBudget, ForgetsWhatIsOlderThanTheWindow) {
  RestartBudget budget({.max = 5, .window = 30s});
  for (int i = 0; i < 5; ++i) budget.spend(start + i * 1s, never_active);
  EXPECT_TRUE(budget.spend(start + 30s + 1ms, never_active));
  EXPECT_FALSE(budget.spend(start + 30s + 2ms, never_active));
}

TEST(RestartBudget, IsWholeAgainWhenTheCauseIsGone) {
  RestartBudget budget({.max = 1, .window = 30s});
  budget.spend(start, never_active);
  budget.forgive();
  EXPECT_EQ(budget.spend(start, never_active), 100ms);
}

}  // namespace
}  // namespace kervan::supervisor
