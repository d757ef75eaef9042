// A run under lockstep in several processes, one of which dies or stands still: over for all, at once and by name.
#include <gtest/gtest.h>
#include <signal.h>

#include <iostream>

#include "tests/deploy/supervised.hpp"

namespace kervan::test {
namespace {

using Clock = std::chrono::steady_clock;

/// Three that hear each other and never come to an end.
const std::string three =
    "components:\n"
    "  a: {type: test/beacon, remap: {in: c/out}}\n"
    "  b: {type: test/beacon, remap: {in: a/out}}\n"
    "  c: {type: test/beacon, remap: {in: b/out}}\n"
    "containers: {one: {components: [a]}, two: {components: [b]}, three: {components: [c]}}\n";

class LockstepEnd : public testing::TestWithParam<int> {};

TEST_P(LockstepEnd, OfAnyContainerEndsTheRunWithItsName) {
  const std::string cause =
      GetParam() == SIGKILL ? "died of SIGKILL" : "was stopped (SIGSTOP), which is as good as dead";
  for (const std::string victim : {"one", "two", "three"}) {
    Supervised run(three, "lockstep");
    for (int i = 0; i < 3; ++i) run.wait_for("heard ");
    const auto start = Clock::now();
    ::kill(run.container(victim), GetParam());
    const Result result = run.wait();
    std::cout << victim << ": everything gone after " << std::chrono::duration<double>(Clock::now() - start).count()
              << " s\n";
    EXPECT_EQ(result.code, 1) << result.err;
    EXPECT_EQ(run.summary()["result"], "aborted");
    const std::string reason = run.summary()["reason"];
    EXPECT_TRUE(reason.starts_with("the container " + victim + " " + cause + " at ")) << reason;
    EXPECT_TRUE(reason.ends_with("; under clock lockstep no container is started again")) << reason;
    for (const char* name : {"one", "two", "three"})
      EXPECT_EQ(run.row(name)["exit"].get<std::string>().substr(0, 4), name == victim ? "SIGK" : "exit") << name;
  }
}

INSTANTIATE_TEST_SUITE_P(By, LockstepEnd, testing::Values(SIGKILL, SIGSTOP),
                         [](const auto& test) { return test.param == SIGKILL ? "Kill" : "Stop"; });

TEST(LockstepEnd, ByCtrlCIsInGoodOrder) {
  Supervised run(three, "lockstep");
  for (int i = 0; i < 3; ++i) run.wait_for("heard ");
  run.signal(SIGINT);
  const Result result = run.wait();
  EXPECT_EQ(result.code, 130) << result.err;
  EXPECT_EQ(run.summary()["result"], "aborted");
  EXPECT_EQ(run.summary()["reason"], "interrupted");
  for (const char* name : {"one", "two", "three"}) EXPECT_EQ(run.row(name)["exit"], "exit 0") << name;
}

}  // namespace
}  // namespace kervan::test
