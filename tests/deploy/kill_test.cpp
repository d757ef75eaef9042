// Each container of the laboratory but the simulator's is killed or stopped in turn, while the robot drives under clock
// sim at the pace of real time. Judged on simulated time: braking begins within 250 ms of the last fresh command.
// Measured on the wall: how long it takes until the container is active again.
//
// The fast run is two rounds; KERVAN_KILL_ROUNDS asks for more, KERVAN_KILL_LOAD for so many busy threads beside.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <thread>

#include "tests/deploy/supervised.hpp"

namespace kervan::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kFullBraking = 0.6;  ///< m/s2, of robots/p3dx.yaml
constexpr double kLongest = 0.250;    ///< s, from the last fresh command to the beginning of full braking
/// s: the guard brakes within the same time, but what it says takes a step of the simulator to reach the drive from
/// another process.
constexpr double kWay = 0.010;
constexpr double kStanding = 0.05;  ///< m/s
constexpr const char* kVictims[] = {"control", "safety", "plan", "observe"};

int number_from(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::atoi(text) : otherwise;
}

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
                               {"observe", "[report, mission]" + restart}});
  const auto replace = [&](const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    if (at == std::string::npos) throw std::runtime_error("lab.yaml no longer has '" + from + "'");
    text.replace(at, from.size(), to);
  };
  replace("  report:\n",
          "  recorder: {type: test/drive_recorder, remap: {raw: r1/guard/cmd_vel_raw, command: r1/guard/cmd_vel, "
          "truth: world/r1/truth}}\n  report:\n");
  replace("timeout: 90s", "timeout: 900s");
  if (short_way) replace("[[16.0 m, 7.8 m]]", "[[4.0 m, 3.0 m]]");
  return text;
}

struct Sample {
  double time, value;
};

struct Recording {
  std::vector<Sample> raw, command, speed;
};

Recording read(const std::string& csv) {
  Recording recording;
  for (const std::string& line : lines_of(csv)) {
    std::istringstream fields(line);
    std::string what, time, value;
    std::getline(fields, what, ',');
    std::getline(fields, time, ',');
    std::getline(fields, value, ',');
    auto& samples = what == "raw" ? recording.raw : what == "command" ? recording.command : recording.speed;
    samples.push_back({std::stod(time) * 1e-9, std::stod(value)});
  }
  return recording;
}

/// How long after `last` the speed began to fall as fast as it can and went on so until it stood, or until `next`.
/// Negative: the robot stood anyway. Infinite: it never did.
double braking_after(const std::vector<Sample>& speed, double last, double next) {
  const auto at = [&](double time) {
    return std::lower_bound(speed.begin(), speed.end(), time, [](const Sample& s, double t) { return s.time < t; });
  };
  const auto begin = at(last), latest = at(last + kLongest), end = at(next);
  if (begin == speed.end() || latest == speed.end() || std::abs(latest->value) < kStanding) return -1.0;
  double start = INFINITY;
  for (auto one = begin; one != end && one + 1 != speed.end(); ++one) {
    const double fall = std::abs(one->value) - std::abs((one + 1)->value), dt = (one + 1)->time - one->time;
    const bool full = fall >= 0.95 * kFullBraking * dt;
    if (full && std::isinf(start)) start = one->time - last;
    if (!full && (one + 1)->time < last + kLongest) start = INFINITY;  // it had only slowed down
  }
  return start;
}

struct Figures {
  std::vector<double> braking;  ///< s after the last fresh command
  std::vector<double> back;     ///< s of the wall from the signal until active again
  int standing = 0, missions = 0;
};

void judge_braking(const Recording& recording, Figures& figures) {
  for (const auto* stream : {&recording.raw, &recording.command}) {
    for (std::size_t i = 0; i + 1 < stream->size(); ++i) {
      const double last = (*stream)[i].time, next = (*stream)[i + 1].time;
      if (next - last <= kLongest + 0.02) continue;
      const double after = braking_after(recording.speed, last, next);
      if (after < 0.0) {
        ++figures.standing;
        continue;
      }
      figures.braking.push_back(after);
      const double longest = stream == &recording.raw ? kLongest + kWay : kLongest;
      EXPECT_LE(after, longest + 1e-6) << "the last fresh " << (stream == &recording.raw ? "wanted" : "told")
                                       << " speed came at " << last << " s";
    }
  }
}

/// One drive through the laboratory; `round` counts on over all of them.
void drive(int& round, int rounds, bool short_way, const std::string& backoff, Figures& figures) {
  Supervised run(composition(short_way, backoff), "sim, step: 10ms, pace: real-time");
  const int until = short_way ? rounds : std::min(rounds, round + 16);
  while (round < until) {
    run.wait_for(" recorder] driving");
    const std::string victim = kVictims[round % 4];
    const int signal = (round / 4 + round) % 2 == 0 ? SIGKILL : SIGSTOP;
    ++round;
    const auto start = Clock::now();
    ::kill(run.container(victim), signal);
    run.wait_for("the container " + victim + " is active again");
    figures.back.push_back(std::chrono::duration<double>(Clock::now() - start).count());
  }
  const Result result = run.wait();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(run.summary()["result"], "success") << result.out << result.err;
  EXPECT_EQ(run.row("sim")["restarts"], 0);
  ++figures.missions;
  judge_braking(read(run.file("drive.csv")), figures);
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
  for (int round = 0; round < rounds;) drive(round, rounds, rounds < 8, GetParam(), figures);
  std::cout << rounds << " rounds in " << figures.missions << " missions, " << load << " busy threads beside\n";
  print("from the last fresh command to full braking", figures.braking);
  print("from the signal until active again", figures.back);
  std::cout << "commands that stopped while the robot stood: " << figures.standing << "\n";
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
