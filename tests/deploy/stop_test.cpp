// Every way to end a run from outside, after which no process of it is left.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "tests/deploy/supervised.hpp"

namespace kervan::test {
namespace {

using Clock = std::chrono::steady_clock;

/// How often a run is ended in each way; the heavy test asks for more.
int rounds() {
  const char* text = std::getenv("KERVAN_STOP_ROUNDS");
  return text ? std::atoi(text) : 3;
}

const std::string four =
    "components: {a: {type: test/beacon}, b: {type: test/beacon}, c: {type: test/beacon}, d: {type: test/beacon}}\n"
    "containers: {one: {components: [a]}, two: {components: [b]}, three: {components: [c]}, four: {components: [d]}}\n";

void wait_until_active(Supervised& run, int count) {
  for (int i = 0; i < count; ++i) run.wait_for("here in");
}

/// Seconds from the signal until the last process is gone.
double end_with(int signal, int exit_code) {
  Supervised run(four);
  wait_until_active(run, 4);
  EXPECT_EQ(run.containers().size(), 4u);
  const auto start = Clock::now();
  run.signal(signal);
  const Result result = run.wait();
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  EXPECT_EQ(result.code, exit_code) << result.err;
  EXPECT_TRUE(run.containers().empty());
  EXPECT_EQ(run.summary()["result"], "aborted");
  EXPECT_EQ(run.summary()["interrupted"], true);
  EXPECT_EQ(run.summary()["reason"], "interrupted");
  for (const char* name : {"one", "two", "three", "four"}) EXPECT_EQ(run.row(name)["exit"], "exit 0") << name;
  return seconds;
}

TEST(Stop, SigtermLeavesNothingBehind) {
  double longest = 0.0;
  for (int i = 0; i < rounds(); ++i) longest = std::max(longest, end_with(SIGTERM, 143));
  std::cout << rounds() << " runs, everything was gone after " << longest << " s at most\n";
}

TEST(Stop, CtrlCLeavesNothingBehind) { end_with(SIGINT, 130); }

TEST(Stop, ContainersThatDoNotEndAreKilled) {
  Supervised run(
      "components: {a: {type: test/beacon}, b: {type: test/saboteur, params: {where: deactivate, how: hang}}}\n"
      "containers: {one: {components: [a]}, two: {components: [b]}}\n");
  run.wait_for("here in");
  run.signal(SIGTERM);
  EXPECT_EQ(run.wait().code, 143);
  EXPECT_EQ(run.row("one")["exit"], "exit 0");
  EXPECT_EQ(run.row("two")["exit"], "SIGTERM");
}

TEST(Stop, ASecondCtrlCKillsAtOnce) {
  Supervised run(
      "components: {a: {type: test/beacon}, b: {type: test/saboteur, params: {where: deactivate, how: hang}}}\n"
      "containers: {one: {components: [a]}, two: {components: [b]}}\n");
  run.wait_for("here in");
  run.signal(SIGINT);
  run.wait_for("SIGINT: the containers are told to end; another one kills them");
  run.signal(SIGINT);
  EXPECT_EQ(run.wait().code, 130);
  EXPECT_EQ(run.row("two")["exit"], "SIGKILL");
}

TEST(Stop, BeforeTheContainersHaveFoundEachOther) {
  Supervised run(
      "components: {a: {type: test/saboteur, params: {where: constructor, how: hang}}, b: {type: test/beacon}}\n"
      "containers: {one: {components: [a]}, two: {components: [b]}}\n");
  run.wait_for("waiting for one (starting), two (matched)");
  run.signal(SIGTERM);
  EXPECT_EQ(run.wait().code, 143);
  EXPECT_EQ(run.summary()["result"], "aborted");
}

TEST(Stop, ASupervisorThatIsKilledTakesItsContainersAlong) {
  Supervised run(four);
  wait_until_active(run, 4);
  run.signal(SIGKILL);
  run.wait_until_nobody_lives();
  EXPECT_TRUE(run.containers().empty());
}

}  // namespace
}  // namespace kervan::test
