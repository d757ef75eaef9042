// A container that was killed or stopped comes back with everything it had.
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/deploy/supervised.hpp"

namespace kervan::test {
namespace {

const std::string pair =
    "components:\n"
    "  a: {type: test/beacon, params: {word: a is here}, remap: {out: /a, in: /b}}\n"
    "  b: {type: test/beacon, params: {word: b is here}, remap: {out: /b, in: /a}}\n"
    "containers:\n"
    "  one: {components: [a]}\n"
    "  two: {components: [b]}\n";

/// Both live, and each has heard the other.
void wait_for_both(Supervised& run) {
  for (int i = 0; i < 2; ++i) run.wait_for("] heard ");
}

class Restart : public testing::TestWithParam<int> {};

TEST_P(Restart, BringsComponentsParametersAndLatchedDataBack) {
  Supervised run(pair);
  wait_for_both(run);
  const pid_t two = run.container("two"), one = run.container("one");
  ::kill(two, GetParam());
  EXPECT_EQ(run.wait_for("the container two "),
            GetParam() == SIGKILL
                ? "the container two died of SIGKILL; it is started again in 0.1 s (1 of 5 within 30 s)"
                : "the container two was stopped (SIGSTOP), which is as good as dead; it is started "
                  "again in 0.1 s (1 of 5 within 30 s)");
  EXPECT_NE(run.wait_for("b is here in "), "") << "its parameters came back";
  const pid_t again = run.container("two");
  EXPECT_NE(again, two);
  EXPECT_EQ(run.container("one"), one);
  // Each hears the other, in whichever order: what was latched is there again.
  for (int i = 0; i < 2; ++i) {
    const std::string line = run.wait_for("] heard ");
    EXPECT_TRUE(line.ends_with(" a] heard " + std::to_string(again)) ||
                line.ends_with(" b] heard " + std::to_string(one)))
        << line << "\n"
        << run.said();
  }
  run.signal(SIGTERM);
  EXPECT_EQ(run.wait().code, 143);
  EXPECT_EQ(run.row("two")["restarts"], 1);
  EXPECT_EQ(run.row("two")["pid"], again);
  EXPECT_EQ(run.row("one")["restarts"], 0);
}

INSTANTIATE_TEST_SUITE_P(After, Restart, testing::Values(SIGKILL, SIGSTOP),
                         [](const auto& test) { return test.param == SIGKILL ? "Kill" : "Stop"; });

TEST(EndFromOutside, IsLeftAloneUnlessThePolicySaysAlways) {
  Supervised run(pair.substr(0, pair.size() - 2) + ", restart: {policy: always}}\n");
  wait_for_both(run);
  ::kill(run.container("two"), SIGTERM);
  run.wait_for("the container two was ended from outside; it is started again in 0.1 s");
  run.wait_for("b is here");
  ::kill(run.container("one"), SIGTERM);
  EXPECT_EQ(run.wait_for("the container one "), "the container one was ended from outside");
  run.signal(SIGTERM);
  run.wait();
  EXPECT_EQ(run.row("one")["restarts"], 0);
  EXPECT_EQ(run.row("two")["restarts"], 1);
}

}  // namespace
}  // namespace kervan::test
