// Each container of the laboratory but the simulator's is killed or stopped in turn, while the robot drives under clock
// sim at the pace of real time. Judged on simulated time: wherever the commands stop, full braking begins within 250 ms
// of the last fresh one. Measured on the wall: how long it takes until the container is active again.
//
// The fast run is two rounds, both on the way of the commands; KERVAN_KILL_ROUNDS asks for more, KERVAN_KILL_LOAD for
// so many busy threads beside.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <iostream>
#include <thread>

#include "tests/deploy/drive_recording.hpp"
#include "tests/deploy/supervised.hpp"

namespace kervan::test {
namespace {

using Clock = std::chrono::steady_clock;

/// Keeps so many cores busy while it exists.
class Load {
 public:
  explicit Load(int threads) {
    for (int i = 0; i < threads; ++i)
      threads_.emplace_back([this] {
        while (!stop_.load(std::memory_order_relaxed)) {
        }
      });
  }
  ~Load() {
    stop_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

 private:
  std::atomic<bool> stop_ = false;
  std::vector<std::thread> threads_;
};

/// After so short a wait a container is back before anybody misses it; after so long a one the robot must have braked.
constexpr const char* kSoon = "100ms";
constexpr const char* kLate = "600ms";

std::string composition(bool short_way, const std::string& backoff) {
  const std::string restart = ", restart: {policy: on-failure, max: 1000, backoff: " + backoff + "}";
  std::string text = lab_over({{"sim", "[world, recorder]"},
                               {"plan", "[r1/planner, r1/follower]" + restart},
                               {"control", "[r1/control]" + restart},
                               {"safety", "[r1/guard]" + restart},
                               {"observe", "[report, mission]" + restart}},
                              {kDriveRecorder});
  const auto replace = [&](const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    if (at == std::string::npos) throw std::runtime_error("lab.yaml no longer has '" + from + "'");
    text.replace(at, from.size(), to);
  };
  replace("timeout: 90s", "timeout: 900s");
  if (short_way) replace("[[16.0 m, 7.8 m]]", "[[4.0 m, 3.0 m]]");
  return text;
}

/// One signal to one container.
struct Round {
  std::string victim;
  int signal;

  /// Without it no command reaches the drive.
  bool on_the_way() const { return victim == "control" || victim == "safety"; }
};

std::deque<Round> in_turn(int rounds) {
  std::deque<Round> all;
  for (int i = 0; i < rounds; ++i)
    all.push_back(
        {(const char*[]){"control", "safety", "plan", "observe"}[i % 4], (i / 4 + i) % 2 == 0 ? SIGKILL : SIGSTOP});
  return all;
}

/// A round that was begun at this time of the simulator.
struct Strike {
  Round round;
  double time;
};

struct Figures {
  std::vector<double> wanted, told;  ///< s from the last fresh command of the controller, of the guard, to full braking
  std::vector<double> lost;          ///< s in which full braking did not go on
  std::vector<double> back;          ///< s of the wall from the signal until active again
  int braked = 0;                    ///< rounds on the commands' way that silenced them for more than 250 ms
  int too_short = 0;                 ///< and that did not
  int standing = 0;                  ///< that hit a robot which no longer drove
  int held_up = 0;                   ///< silences in which the guard itself did not get its turn
  int missions = 0;
};

/// The commands stopped because of the strike; nullptr if they did not stop for long.
const Silence* silence_of(const Strike& strike, const std::vector<Silence>& silences) {
  constexpr double before = 0.2, reaction = 1.0;  // of the last command; of whoever reads the line and sends the signal
  for (const Silence& silence : silences)
    if (silence.last >= strike.time - before && silence.last <= strike.time + reaction) return &silence;
  return nullptr;
}

/// How much longer than it is allowed the guard was without its turn when it had to brake: on a machine that starves
/// it, it cannot. It may be late by 50 ms, for its turn and both ways together.
double held_up(const DriveRecording& recording, double last) {
  constexpr double allowed = 0.030;
  return std::max(0.0, longest_pause(recording.command, last, last + kLongest) - kPeriod - allowed);
}

/// Returns the rounds that have to be repeated, because they hit a robot that did not drive.
std::deque<Round> judge(const std::vector<Strike>& strikes, const DriveRecording& recording, Figures& figures) {
  const auto wanted = silences(recording.raw, recording.speed), told = silences(recording.command, recording.speed);
  for (const auto* stream : {&wanted, &told}) {
    for (const Silence& silence : *stream) {
      if (!silence.braking) continue;
      const double longest = kLongest + (stream == &wanted ? held_up(recording, silence.last) : 0.0) + 1e-6;
      if (longest > kLongest + 1e-5) ++figures.held_up;
      // Commands that came back in time end what they began.
      if (std::isinf(*silence.braking) && silence.next - silence.last <= longest) continue;
      (stream == &wanted ? figures.wanted : figures.told).push_back(*silence.braking);
      figures.lost.push_back(silence.lost);
      EXPECT_LE(*silence.braking, longest)
          << "the last fresh " << (stream == &wanted ? "wanted" : "told") << " speed came at " << silence.last << " s\n"
          << excerpt(recording, silence.last - 0.2, silence.last + 2.0 * kLongest);
    }
  }
  std::deque<Round> again;
  for (const Strike& strike : strikes) {
    if (!strike.round.on_the_way()) continue;
    const Silence* silence = silence_of(strike, strike.round.victim == "control" ? wanted : told);
    if (!silence) {
      ++figures.too_short;
    } else if (silence->braking) {
      ++figures.braked;
    } else {
      ++figures.standing;
      again.push_back(strike.round);
    }
  }
  return again;
}

/// One drive through the laboratory, with as many rounds as it has room for.
void drive(std::deque<Round>& rounds, bool short_way, const std::string& backoff, Figures& figures) {
  Supervised run(composition(short_way, backoff), "sim, step: 10ms, pace: real-time");
  std::vector<Strike> strikes;
  const std::string driving = " recorder] driving at ";
  for (; !rounds.empty() && strikes.size() < 16; rounds.pop_front()) {
    const Round& round = rounds.front();
    const std::string line = run.wait_for(driving);
    strikes.push_back({round, std::stod(line.substr(line.find(driving) + driving.size())) * 1e-9});
    const auto start = Clock::now();
    ::kill(run.container(round.victim), round.signal);
    run.wait_for("the container " + round.victim + " is active again");
    figures.back.push_back(std::chrono::duration<double>(Clock::now() - start).count());
  }
  const Result result = run.wait(std::chrono::minutes(10));  // the rest of the way, slower on a busy machine
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(run.summary()["result"], "success") << result.out << result.err;
  EXPECT_EQ(run.row("sim")["restarts"], 0);
  ++figures.missions;
  const auto again = judge(strikes, read_drive(run.file("drive.csv")), figures);
  rounds.insert(rounds.end(), again.begin(), again.end());
}

void print(const char* what, std::vector<double> seconds) {
  if (seconds.empty()) return;
  std::ranges::sort(seconds);
  const auto percentile = [&](double share) {
    return seconds[static_cast<std::size_t>(share * static_cast<double>(seconds.size() - 1) + 0.5)] * 1e3;
  };
  std::cout << what << " (" << seconds.size() << "): median " << percentile(0.5) << " ms, p95 " << percentile(0.95)
            << " ms, longest " << percentile(1.0) << " ms\n";
}

class Kill : public testing::TestWithParam<const char*> {};

TEST_P(Kill, OfAnyContainerButTheSimulatorsBrakesTheRobotAndTheMissionSucceedsAllTheSame) {
  const int rounds = number_from("KERVAN_KILL_ROUNDS", 2);
  const int load = number_from("KERVAN_KILL_LOAD", 0);
  const Load busy(load);
  Figures figures;
  for (auto left = in_turn(rounds); !left.empty();) drive(left, rounds < 8, GetParam(), figures);
  std::cout << rounds << " rounds in " << figures.missions << " missions, " << load << " busy threads beside\n";
  std::cout << "rounds that hit the commands' way: braked " << figures.braked << ", silent for less than 250 ms "
            << figures.too_short << ", repeated because the robot stood " << figures.standing << "\n";
  print("from the controller's last fresh command to full braking", figures.wanted);
  print("from the guard's last fresh command to full braking", figures.told);
  print("of that braking lost because the guard was late", figures.lost);
  std::cout << "silences in which the machine held the guard up, too: " << figures.held_up << "\n";
  print("from the signal until active again", figures.back);
  if (GetParam() == kLate) {
    EXPECT_EQ(figures.too_short, 0) << "a restart that late silences the commands for longer";
  }
}

INSTANTIATE_TEST_SUITE_P(RestartedAfter, Kill, testing::Values(kSoon, kLate),
                         [](const auto& test) { return std::string(test.param); });

class KillOfTheSimulator : public testing::TestWithParam<int> {};

TEST_P(KillOfTheSimulator, EndsTheRunWithItsName) {
  const std::string cause =
      GetParam() == SIGKILL ? "died of SIGKILL" : "was stopped (SIGSTOP), which is as good as dead";
  Supervised run(composition(true, kSoon), "sim, step: 10ms, pace: real-time");
  run.wait_for(" recorder] driving");
  const auto start = Clock::now();
  ::kill(run.container("sim"), GetParam());
  run.wait_for("the container sim " + cause);
  const auto named = std::chrono::duration<double>(Clock::now() - start).count();
  const Result result = run.wait();
  std::cout << "named after " << named << " s, everything gone after "
            << std::chrono::duration<double>(Clock::now() - start).count() << " s\n";
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(run.summary()["result"], "aborted");
  const std::string reason = run.summary()["reason"];
  EXPECT_TRUE(reason.starts_with("the container sim " + cause + " at ")) << reason;
  EXPECT_TRUE(reason.ends_with(" s; it keeps the time, so the run is over")) << reason;
}

INSTANTIATE_TEST_SUITE_P(By, KillOfTheSimulator, testing::Values(SIGKILL, SIGSTOP),
                         [](const auto& test) { return test.param == SIGKILL ? "Kill" : "Stop"; });

}  // namespace
}  // namespace kervan::test
