// What a run that is ended from outside leaves behind: the drive stands, and what there is of results is kept.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>

#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A named pipe through which the run tells its commands: reading from it is how the test knows how far the run is, and
/// since it holds little, a run that is faster than its reader waits.
class Commands {
 public:
  explicit Commands(fs::path file) : file_(std::move(file)) {
    if (::mkfifo(file_.c_str(), 0600) != 0) throw std::runtime_error("cannot make a pipe");
    pipe_ = ::open(file_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    ::fcntl(pipe_, F_SETPIPE_SZ, 4096);
  }
  ~Commands() { ::close(pipe_); }

  const fs::path& file() const { return file_; }

  /// Reads until `count` commands have come, or all until the writer closes.
  void read_until(std::size_t count) {
    while (lines_of(text_).size() < count) {
      pollfd readable{pipe_, POLLIN, 0};
      if (::poll(&readable, 1, 30000) != 1) throw std::runtime_error("no command has come for 30 s");
      std::array<char, 1024> buffer{};
      const auto size = ::read(pipe_, buffer.data(), buffer.size());
      if (size <= 0) return;
      text_.append(buffer.data(), static_cast<std::size_t>(size));
    }
  }
  void read_all() { read_until(static_cast<std::size_t>(-1)); }
  std::vector<std::string> lines() const { return lines_of(text_); }

 private:
  fs::path file_;
  int pipe_ = -1;
  std::string text_;
};

struct Ending {
  int signal;
  int exit_code;
};

void interrupt(const std::string& clock, Ending ending) {
  const Folder folder, pipes;
  Commands commands(pipes.path() / "commands");
  Process process({KERVAN_PROGRAM,
                   {"run", SCENARIO_TESTS "/compositions/one_robot.yaml", "--json", "--arg", "clock=" + clock, "--arg",
                    "commands=" + commands.file().string()},
                   {{"KERVAN_COMPONENT_PATH", SCENARIO_COMPONENTS}}},
                  folder.path());
  commands.read_until(20);  // 20 a second: the robot is on its way
  process.signal(ending.signal);
  commands.read_all();
  const Result result = process.wait();
  EXPECT_EQ(result.code, ending.exit_code) << result.err;

  const auto lines = commands.lines();
  ASSERT_GE(lines.size(), 21u);
  EXPECT_NE(lines[lines.size() - 2], "0 0") << "the robot drove";
  EXPECT_EQ(lines.back(), "0 0") << "the drive's last command";

  ASSERT_FALSE(result.out.empty()) << result.err;
  const json summary = json::parse(result.out);
  EXPECT_EQ(summary["interrupted"], true);
  EXPECT_EQ(summary["result"], "aborted");
  EXPECT_EQ(summary["reason"], "interrupted before the mission was over");
  EXPECT_FALSE(summary["robots"]["r1"]["reached"].get<bool>());
  EXPECT_GT(summary["robots"]["r1"]["path_m"].get<double>(), 0.0);
  for (const auto& entry : fs::directory_iterator(folder.path() / "runs")) {
    EXPECT_EQ(json::parse(text_of(entry.path() / "summary.json")), summary);
    EXPECT_GE(lines_of(text_of(entry.path() / "trajectory.csv")).size(), 5u);
    EXPECT_TRUE(text_of(entry.path() / "map.svg").find("</svg>") != std::string::npos);
    EXPECT_NE(text_of(entry.path() / "log.txt").find("the last command is zero"), std::string::npos);
  }
}

TEST(Interrupt, LeavesAStandingRobotAndPartialResultsUnderTheWallClock) { interrupt("wall", {SIGINT, 130}); }

TEST(Interrupt, LeavesAStandingRobotAndPartialResultsInLockstep) { interrupt("lockstep", {SIGINT, 130}); }

TEST(Interrupt, LeavesTheSameWhenTerminated) { interrupt("lockstep", {SIGTERM, 143}); }

}  // namespace
}  // namespace kervan::test
