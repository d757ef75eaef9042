// What is said of a container that broke, and what becomes of the run.
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/deploy/drive_recording.hpp"
#include "tests/deploy/supervised.hpp"

namespace kervan::test {
namespace {

/// A container `bad` with one component that does this, and a container `good` beside it.
std::string with_saboteur(const std::string& parameters, const std::string& restart) {
  return "components:\n"
         "  good: {type: test/beacon}\n"
         "  bad: {type: test/saboteur, params: {" +
         parameters +
         "}}\n"
         "containers:\n"
         "  one: {components: [good]}\n"
         "  two: {components: [bad], restart: {" +
         restart + "}}\n";
}

struct Place {
  const char* name;
  const char* parameters;
  const char* first_line;  ///< of the crash report; '*' stands for an address that nobody knows before
};
void PrintTo(const Place& place, std::ostream* out) { *out << place.name; }

class CrashReport : public testing::TestWithParam<Place> {};

TEST_P(CrashReport, NamesContainerSignalComponentAndHandler) {
  Supervised run(with_saboteur(GetParam().parameters, "policy: never"));
  const std::string name = GetParam().name;
  if (name == "Constructor") {
    EXPECT_EQ(run.wait().code, 1);  // it had never been active
  } else {
    run.wait_for(name == "Deactivation" ? "here in" : "stays stopped");
    run.signal(SIGTERM);
    run.wait();
  }
  const auto lines = lines_of(run.file("crash-two.txt"));
  ASSERT_GT(lines.size(), 2u) << "there is no report, or no backtrace in it\n" << run.said();
  std::string first = lines[0];
  const std::string expected = GetParam().first_line;
  if (const auto star = expected.find('*'); star != std::string::npos)
    first.replace(star, first.find(' ', star) - star, "*");
  EXPECT_EQ(first, expected);
  EXPECT_NE(run.said().find(lines[0] + "\n"), std::string::npos) << "the console does not show it";
  EXPECT_EQ(run.row("two")["exit"], name == "Abort" ? "SIGABRT" : "SIGSEGV");
}

INSTANTIATE_TEST_SUITE_P(
    In, CrashReport,
    testing::Values(
        Place{"Constructor", "where: constructor", "container two crashed: SIGSEGV in bad (in its constructor)"},
        Place{"Activation", "where: activate", "container two crashed: SIGSEGV in bad (in on_activate)"},
        Place{"Timer", "where: timer, how: \"null\"",
              "container two crashed: SIGSEGV at address 0x10 in bad (in a timer)"},
        Place{"Overflow", "where: timer, how: overflow",
              "container two crashed: SIGSEGV at address * in bad (in a timer)"},
        Place{"Abort", "where: timer, how: abort", "container two crashed: SIGABRT in bad (in a timer)"},
        Place{"Deactivation", "where: deactivate", "container two crashed: SIGSEGV in bad (in on_deactivate)"}),
    [](const auto& test) { return test.param.name; });

TEST(Crash, ThatRepeatsItselfAtTheStartEndsTheRunAfterFiveRestarts) {
  Supervised run(with_saboteur("where: constructor", "policy: on-failure, max: 5, window: 30s"));
  const Result result = run.wait();
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(run.summary()["result"], "aborted");
  EXPECT_EQ(run.summary()["reason"],
            "the container two stays stopped: it was started again 5 times within 30 s; the last time it crashed: "
            "SIGSEGV in bad (in its constructor)");
  EXPECT_EQ(run.row("two")["restarts"], 5);
  EXPECT_EQ(run.row("two")["exit"], "SIGSEGV");
  EXPECT_EQ(run.row("one")["restarts"], 0);
  EXPECT_NE(result.err.find("the container two crashed: SIGSEGV in bad (in its constructor); it is started again in "
                            "0.1 s (1 of 5 within 30 s)\n"),
            std::string::npos)
      << result.err;
}

class CrashBesideTheController : public testing::TestWithParam<const char*> {};

TEST_P(CrashBesideTheController, AtEveryStartEndsTheRunAndTheRobotNeverMoved) {
  Supervised run(
      lab_over({{"sim", "[world, recorder]"},
                {"control", "[r1/control, bad]"},
                {"rest", "[r1/planner, r1/follower, r1/guard, report, mission]"}},
               {kDriveRecorder, "bad: {type: test/saboteur, params: {where: " + std::string(GetParam()) + "}}"}),
      "sim, step: 10ms, pace: real-time");
  EXPECT_EQ(run.wait().code, 1);
  EXPECT_EQ(run.summary()["result"], "aborted");
  const std::string reason = run.summary()["reason"];
  EXPECT_TRUE(
      reason.starts_with("the container control stays stopped: it was started again 5 times within 30 s; the "
                         "last time it crashed: SIGSEGV in bad"))
      << reason;
  EXPECT_EQ(run.row("control")["restarts"], 5);
  const DriveRecording recording = read_drive(run.file("drive.csv"));
  // The others wait for a container that cannot be made, but not for one that has been.
  EXPECT_EQ(recording.speed.empty(), std::string(GetParam()) == "constructor");
  for (const auto* stream : {&recording.raw, &recording.command, &recording.speed})
    EXPECT_TRUE(std::ranges::all_of(*stream, [](const SpeedAt& one) { return one.value == 0.0; }));
}

INSTANTIATE_TEST_SUITE_P(In, CrashBesideTheController, testing::Values("constructor", "activate"),
                         [](const auto& test) { return std::string(test.param); });

TEST(Crash, OfAContainerThatHadBeenActiveLeavesTheOthersRunning) {
  Supervised run(with_saboteur("where: timer, after: 200ms", "policy: on-failure, max: 2, window: 30s"));
  EXPECT_EQ(run.wait_for("stays stopped"),
            "the container two stays stopped: it was started again 2 times within 30 s; the last time it crashed: "
            "SIGSEGV in bad (in a timer)");
  EXPECT_EQ(run.containers().size(), 1u);
  run.signal(SIGTERM);
  EXPECT_EQ(run.wait().code, 143);
  EXPECT_EQ(run.row("two")["restarts"], 2);
}

TEST(Crash, UnderLockstepEndsTheRunAndNamesContainerCauseAndTime) {
  Supervised run(with_saboteur("where: timer, after: 1s", "policy: on-failure"), "lockstep");
  EXPECT_EQ(run.wait().code, 1);
  EXPECT_EQ(run.summary()["result"], "aborted");
  EXPECT_EQ(run.summary()["reason"],
            "the container two crashed: SIGSEGV in bad (in a timer) at 1.00 s; under clock lockstep no container is "
            "started again");
}

TEST(Refusal, AtConstructionEndsTheRunAsAMistakeOfConfigurationAndLeavesNothingBehind) {
  Supervised run(with_saboteur("where: constructor, how: refuse", "policy: on-failure"));
  const Result result = run.wait();
  EXPECT_EQ(result.code, 2);
  EXPECT_EQ(result.err, "container two: bad.how: it is refused here and nowhere else\n");
  EXPECT_EQ(run.files(), (std::vector<std::string>{"c.yaml", "errors"}));
}

TEST(Death, WithoutAWordIsAReasonToStartAgain) {
  Supervised run(with_saboteur("where: timer, how: exit, after: 100ms", "policy: on-failure, max: 1, window: 30s"));
  run.wait_for("the container two ended without a report (exit 7); it is started again in 0.1 s (1 of 1 within 30 s)");
  run.wait_for("the container two stays stopped");
  run.signal(SIGTERM);
  run.wait();
}

TEST(Quarantine, MovesAComponentThatCrashesIntoAContainerOfItsOwn) {
  Supervised run(
      "components:\n"
      "  first: {type: test/beacon, params: {word: first is here}}\n"
      "  mate: {type: test/beacon, params: {word: mate is here}}\n"
      "  bad: {type: test/saboteur, params: {where: timer, after: 300ms}}\n"
      "containers:\n"
      "  one: {components: [first]}\n"
      "  two: {components: [mate, bad], restart: {policy: quarantine, quarantine: 2}}\n");
  run.wait_for(
      "the container two crashed: SIGSEGV in bad (in a timer); it is started again in 0.1 s (1 of 5 within "
      "30 s)");
  EXPECT_EQ(run.wait_for("made the container"),
            "bad made the container two crash 2 times; from now on it runs by itself in the container two-bad");
  run.wait_for("mate is here");
  run.wait_for("the container two-bad stays stopped: it was started again 5 times within 30 s");
  const auto alive = run.containers();
  EXPECT_EQ(alive.size(), 2u);
  EXPECT_TRUE(alive.contains("one"));
  EXPECT_TRUE(alive.contains("two"));
  run.signal(SIGTERM);
  EXPECT_EQ(run.wait().code, 143);
  EXPECT_EQ(run.row("two")["restarts"], 2);
  EXPECT_EQ(run.row("two-bad")["restarts"], 5);
  EXPECT_EQ(run.row("one")["restarts"], 0);
}

}  // namespace
}  // namespace kervan::test
