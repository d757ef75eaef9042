// The same composition in one process and in several.
#include <gtest/gtest.h>

#include "tests/deploy/supervised.hpp"

namespace kervan::test {
namespace {

std::string trace_of(Supervised& run) {
  const Result result = run.wait();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(run.summary()["result"], "success") << result.out;
  EXPECT_TRUE(run.summary()["robots"]["r1"]["reached"].get<bool>());
  return run.summary()["trace_hash"];
}

TEST(SplitRun, HasTheSameTraceInOneTwoAndFiveContainers) {
  Supervised one(lab_over({{"all", "[\"*\"]"}}), "lockstep");
  const std::string trace = trace_of(one);
  EXPECT_EQ(one.summary()["containers"].size(), 1u);
  EXPECT_TRUE(one.containers().empty());

  Supervised two(lab_over({{"sim", "[world]"}, {"brain", "[r1, report, mission]"}}), "lockstep");
  EXPECT_EQ(trace_of(two), trace);
  EXPECT_EQ(two.summary()["containers"].size(), 2u);

  Supervised five(lab_over({{"sim", "[world]"},
                            {"plan", "[r1/planner, r1/follower]"},
                            {"control", "[r1/control]"},
                            {"safety", "[r1/guard]"},
                            {"observe", "[report, mission]"}}),
                  "lockstep");
  EXPECT_EQ(trace_of(five), trace);
  EXPECT_EQ(five.summary()["containers"].size(), 5u);
}

TEST(SplitRun, EndsForAllWhenTheTimeIsUp) {
  Supervised run(
      "components: {a: {type: test/beacon}, b: {type: test/beacon}}\n"
      "containers: {one: {components: [a]}, two: {components: [b]}}\n",
      "wall", "--for 300ms");
  const Result result = run.wait();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(run.summary()["result"], "success");
  for (const char* name : {"one", "two"}) {
    EXPECT_EQ(run.row(name)["exit"], "exit 0");
    EXPECT_EQ(run.row(name)["restarts"], 0);
    EXPECT_NE(run.file(std::string("log-") + name + ".txt").find("here in"), std::string::npos);
  }
}

TEST(SplitRun, ShowsATableOfItsContainersToAPerson) {
  Supervised run(
      "components: {a: {type: test/beacon}, b: {type: test/beacon}}\n"
      "containers: {one: {components: [a]}, two: {components: [b]}}\n",
      "wall", "--for 100ms");
  run.wait();
  const auto lines = lines_of(run.said());
  ASSERT_GE(lines.size(), 3u);
  EXPECT_EQ(lines[lines.size() - 3], "  container  pid" + std::string(run.row("one")["pid"].dump().size() - 1, ' ') +
                                         "restarts  exit    worst latency  missed deadlines");
  EXPECT_EQ(lines[lines.size() - 2].substr(0, 13), "  one        ");
  EXPECT_EQ(lines[lines.size() - 1].substr(0, 13), "  two        ");
}

}  // namespace
}  // namespace kervan::test
