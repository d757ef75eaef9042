// The container of the behaviour in charge is killed, while a robot follows a wall under clock sim at the pace of real
// time. Judged on simulated time: the arbiter lets go of it within the time its last request is valid for, whoever else
// wants to drive does, and if nobody does the robot brakes within 250 ms of the last fresh request.
//
// KERVAN_KILL_ROUNDS asks for more than two rounds.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <sstream>

#include "tests/deploy/drive_recording.hpp"
#include "tests/deploy/supervised.hpp"

namespace kervan::test {
namespace {

constexpr double kValid = 0.150;  ///< s, of a request, as 10_wall_follow leaves it
constexpr double kStep = 0.010;   ///< s, of the simulator

constexpr const char* kArbitrationRecorder =
    "arbitrations: {type: test/arbitration_recorder, remap: {requests: r1/arbiter/motion_request, "
    "arbitration: r1/arbiter/arbitration, truth: world/r1/truth}}";

/// Two behaviours that are killed have a container each. What judges them shares the simulator's, and with it the time.
std::string composition() {
  const std::string restart = ", restart: {policy: on-failure, max: 1000, backoff: 600ms}";
  return split_over("10_wall_follow",
                    {{"sim", "[world, report, r1/arbiter, r1/guard, arbitrations, recorder]"},
                     {"follow", "[r1/follow]" + restart},
                     {"front", "[r1/front]" + restart},
                     {"others", "[r1/find, r1/convex, r1/sides, r1/bumper, r1/stall]"}},
                    {kArbitrationRecorder, kDriveRecorder});
}

struct Word {
  double time;  ///< s
  std::string behaviour;
};

struct Arbitrations {
  std::vector<Word> wants, drives;
};

Arbitrations read_arbitrations(const std::string& csv) {
  Arbitrations read;
  for (const std::string& line : lines_of(csv)) {
    std::istringstream fields(line);
    std::string what, time, behaviour;
    std::getline(fields, what, ',');
    std::getline(fields, time, ',');
    std::getline(fields, behaviour, ',');
    (what == "wants" ? read.wants : read.drives).push_back({std::stod(time) * 1e-9, behaviour});
  }
  return read;
}

/// The last request of a behaviour whose container was killed soon after `time`: of those up to a second later, the one
/// after which it said nothing for longest.
double last_request(const Arbitrations& all, const std::string& behaviour, double time) {
  double last = std::numeric_limits<double>::quiet_NaN(), before = last, longest = 0.0;
  for (const Word& word : all.wants) {
    if (word.behaviour != behaviour) continue;
    if (before >= time - 0.2 && before <= time + 1.0 && word.time - before > longest) {
      longest = word.time - before;
      last = before;
    }
    before = word.time;
  }
  return longest > kLongest ? last : std::numeric_limits<double>::quiet_NaN();
}

/// s from `last` until the arbiter first named somebody other than `behaviour`, and whom.
Word moved_on(const Arbitrations& all, const std::string& behaviour, double last) {
  for (const Word& word : all.drives)
    if (word.time > last && word.behaviour != behaviour) return {word.time - last, word.behaviour};
  return {std::numeric_limits<double>::infinity(), "the dead one"};
}

class BehaviourKill : public testing::TestWithParam<const char*> {
 protected:
  /// Waits until `behaviour` moves the robot, kills its container, waits until that is back, and returns the time.
  static double strike(Supervised& run, const std::string& behaviour, const std::string& container) {
    const std::string says = "] " + behaviour + " drives at ";
    const std::string line = run.wait_for(says);
    ::kill(run.container(container), SIGKILL);
    run.wait_for("the container " + container + " is active again");
    return std::stod(line.substr(line.find(says) + says.size())) * 1e-9;
  }
};

TEST_P(BehaviourKill, OfTheOneInChargeLetsTheNextDriveOrBrakesTheRobot) {
  const int rounds = number_from("KERVAN_KILL_ROUNDS", 2);
  Supervised run(composition(), "sim, step: 10ms, pace: real-time",
                 std::string("--arg 'start=[5.5 m, 0.53 m, 0 deg]' --arg arbitration=") + GetParam());
  // Along a wall nobody but wall following wants to drive, once wall finding has seen that it is there; where a corner
  // is turned, it waits for the turn to end.
  for (int i = 0; i < 3; ++i) run.wait_for("] wall_follow drives at ");
  std::vector<std::pair<std::string, double>> strikes;
  for (int i = 0; i < rounds; ++i) {
    const bool corner = i % 4 == 1;
    const std::string behaviour = corner ? "front_avoid" : "wall_follow";
    strikes.emplace_back(behaviour, strike(run, behaviour, corner ? "front" : "follow"));
  }
  run.wait_for("] wall_follow drives at ");
  run.signal(SIGTERM);
  run.wait();

  const Arbitrations all = read_arbitrations(run.file("arbitration.csv"));
  const DriveRecording recording = read_drive(run.file("drive.csv"));
  int braked = 0, taken_over = 0;
  for (const auto& [behaviour, time] : strikes) {
    const double last = last_request(all, behaviour, time);
    ASSERT_FALSE(std::isnan(last)) << behaviour << " was not silent after " << time << " s\n" << run.said();
    const Word next = moved_on(all, behaviour, last);
    std::cout << behaviour << " killed: after " << next.time * 1e3 << " ms "
              << (next.behaviour.empty() ? "nobody" : next.behaviour) << " drives";
    EXPECT_LE(next.time, kValid + kStep + 1e-6);
    if (!next.behaviour.empty()) {
      ++taken_over;
      std::cout << "\n";
      continue;
    }
    ++braked;
    std::vector<SpeedAt> wanted;
    for (const Word& word : all.wants)
      if (word.behaviour == behaviour) wanted.push_back({word.time, 0.0});
    const auto silent = silences(wanted, recording.speed);
    const auto silence = std::ranges::find(silent, last, &Silence::last);
    ASSERT_NE(silence, silent.end());
    ASSERT_TRUE(silence->braking) << "the robot stood";
    std::cout << ", full braking after " << *silence->braking * 1e3 << " ms\n";
    EXPECT_LE(*silence->braking, kLongest + 1e-6) << excerpt(recording, last - 0.2, last + 2.0 * kLongest);
  }
  EXPECT_GT(braked, 0);
  EXPECT_GT(taken_over, 0);
}

INSTANTIATE_TEST_SUITE_P(ArbitratedBy, BehaviourKill, testing::Values("requests", "ownership"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace kervan::test
