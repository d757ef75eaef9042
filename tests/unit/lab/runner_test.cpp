// The engine with shell scripts in place of the program: whatever a run does to itself, the others go on.
#include "deploy/lab/runner.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include "tests/program/program.hpp"

using namespace kervan;
using namespace kervan::lab;
namespace fs = std::filesystem;

namespace {

constexpr const char* good = R"(mkdir -p "$2"; echo '{"result": "success", "ended": "finished"}' > "$2/summary.json")";

class Runner : public testing::Test {
 protected:
  /// A run of this script, whose $2 is its folder.
  static lab::Run run(const std::string& name, const std::string& script, std::uint64_t fingerprint = 1) {
    return {name, {"-c", script, "run"}, fingerprint};
  }

  std::vector<RunRecord> make(const std::vector<lab::Run>& runs) {
    const auto records = make_runs(
        runs, {.program = "/bin/sh", .folder = folder_.path(), .jobs = 2, .wall_limit = limit_, .stop = &stop_},
        {.progress = [&](const RunnerProgress& progress) { last_ = progress; },
         .made = [&](std::size_t, const RunRecord&) { ++made_; }});
    return records.value_or(std::vector<RunRecord>{});
  }

  test::Folder folder_;
  std::chrono::duration<double> limit_{60.0};
  std::atomic<bool> stop_ = false;
  RunnerProgress last_;
  std::size_t made_ = 0;
};

TEST_F(Runner, MakesEveryRunAndWritesItsRecord) {
  const auto records = make({run("a", good), run("b", good), run("c", good)});
  ASSERT_EQ(records.size(), 3u);
  for (const auto& record : records) EXPECT_EQ(record.state, RunState::done) << record.reason;
  EXPECT_EQ(folder_.everything_in_it(),
            (std::vector<std::string>{"a", "a/cell.json", "a/summary.json", "b", "b/cell.json", "b/summary.json", "c",
                                      "c/cell.json", "c/summary.json"}));
  EXPECT_EQ(last_.made, 3u);
}

TEST_F(Runner, KeepsWhatIsDone) {
  make({run("a", good), run("b", good)});
  const auto records = make({run("a", "exit 3"), run("b", good, 2)});
  EXPECT_EQ(records[0].state, RunState::done) << "it was made before";
  EXPECT_EQ(records[1].state, RunState::done);
  EXPECT_EQ(made_, 3u) << "only what has changed is made again";
  EXPECT_EQ(last_.kept, 1u);
}

TEST_F(Runner, MakesAgainWhatFailedOrLeftHalfARun) {
  make({run("a", "exit 3"), run("b", good)});
  fs::remove(folder_.path() / "b" / "cell.json");
  std::ofstream(folder_.path() / "b" / "old.txt") << "of half a run";
  const auto records = make({run("a", good), run("b", good)});
  EXPECT_EQ(records[0].state, RunState::done);
  EXPECT_EQ(records[1].state, RunState::done);
  EXPECT_EQ(last_.kept, 0u);
  EXPECT_FALSE(fs::exists(folder_.path() / "b" / "old.txt"));
}

TEST_F(Runner, MakesAgainWhatLostItsSummary) {
  make({run("a", good)});
  fs::remove(folder_.path() / "a" / "summary.json");
  EXPECT_EQ(make({run("a", good)})[0].state, RunState::done);
  EXPECT_EQ(made_, 2u);
}

TEST_F(Runner, SaysWhyARunFailedAndGoesOn) {
  const std::string aborted =
      R"(mkdir "$2"; echo '{"result": "aborted", "ended": "idle", "reason": "nothing is left"}' )"
      R"(> "$2/summary.json"; exit 1)";
  const std::string broken = R"(mkdir "$2"; echo '{"result": "failed", "failures": "r1/control failed: NaN"}' )"
                             R"(> "$2/summary.json"; exit 1)";
  const auto records =
      make({run("crash", "kill -SEGV $$"), run("refused", "echo first; echo 'x.yaml:3:1: alas' >&2; exit 2"),
            run("mute", "exit 0"), run("full", R"(mkdir "$2"; echo '{"result": "succ' > "$2/summary.json")"),
            run("aborted", aborted), run("broken", broken), run("good", good)});
  const std::vector<std::string> reasons = {"SIGSEGV",
                                            "exit 2: x.yaml:3:1: alas",
                                            "exit 0, but it left no summary.json that can be read",
                                            "exit 0, but it left no summary.json that can be read",
                                            "nothing is left",
                                            "r1/control failed: NaN",
                                            ""};
  for (std::size_t i = 0; i < reasons.size(); ++i) {
    EXPECT_EQ(records[i].reason, reasons[i]);
    EXPECT_EQ(records[i].state, reasons[i].empty() ? RunState::done : RunState::failed);
  }
  EXPECT_EQ(test::text_of(folder_.path() / "refused" / "console.txt"), "first\nx.yaml:3:1: alas\n");
  EXPECT_EQ(last_.failed, 6u);
}

TEST_F(Runner, TakesAFailedMissionAndATimeThatIsOverForResults) {
  const std::string failed =
      R"(mkdir "$2"; echo '{"result": "failed", "ended": "finished"}' > "$2/summary.json"; exit 1)";
  const std::string over =
      R"(mkdir "$2"; echo '{"result": "aborted", "ended": "time limit"}' > "$2/summary.json"; exit 1)";
  for (const auto& record : make({run("failed", failed), run("over", over)}))
    EXPECT_EQ(record.state, RunState::done) << record.reason;
}

TEST_F(Runner, KillsARunThatDoesNotEnd) {
  limit_ = std::chrono::duration<double>(0.2);
  const auto records = make({run("hang", "kill -STOP $$"), run("good", good)});
  EXPECT_EQ(records[0].reason, "it did not end within 0.2 s and was killed");
  EXPECT_EQ(records[1].state, RunState::done);
}

TEST_F(Runner, LeavesNothingOfHalfARunWhenItIsStopped) {
  const std::string until_told = R"(mkdir "$2"; touch "$2/half"; kill -STOP $$)";
  const auto records = make_runs(
      {run("a", good), run("b", until_told), run("c", good)},
      {.program = "/bin/sh", .folder = folder_.path(), .jobs = 1, .stop = &stop_},
      {.progress = [&](const RunnerProgress&) { stop_ = fs::exists(folder_.path() / "b" / "half"); }, .made = {}});
  EXPECT_FALSE(records);
  EXPECT_EQ(folder_.everything_in_it(), (std::vector<std::string>{"a", "a/cell.json", "a/summary.json"}));
}

TEST_F(Runner, GoesOnWhereNothingCanBeWritten) {
  std::ofstream(folder_.path() / "b.console") << "";
  fs::remove(folder_.path() / "b.console");
  fs::create_directory(folder_.path() / "b.console");  // no file can be made of this name
  const auto records = make({run("a", good), run("b", good), run("c", good)});
  EXPECT_EQ(records[1].reason,
            "it could not be started: cannot write " + (folder_.path() / "b.console").string() + ": Is a directory");
  EXPECT_EQ(records[2].state, RunState::done);
}

}  // namespace
