/// Simulated time: one container runs it at a pace, the others follow it over loopback. Nothing here asserts how long
/// anything takes.
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "builtin_interfaces/msg/Time.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "framework/runtime/container.hpp"
#include "framework/test/harness.hpp"
#include "rosgraph_msgs/msg/Clock.hpp"

namespace {

using namespace std::chrono_literals;
using builtin_interfaces::msg::Time;
using kervan::runtime::ClockMode;
using kervan::runtime::Container;
using kervan::runtime::ContainerSpec;
using kervan::runtime::RunEnd;

/// Stands for a simulator.
class Ticker final : public kervan::Component {
  kervan::Output<rosgraph_msgs::msg::Clock> clock_{this, "/clock", kervan::qos::state, "The time."};
  kervan::Timer tick_{this, 10ms, &Ticker::on_tick};
  void on_tick(kervan::Time now) {
    rosgraph_msgs::msg::Clock clock;
    clock.clock = kervan::geometry::to_message(now);
    clock_.publish(clock);
  }
};

/// Writes down when its timer ran.
class Watcher final : public kervan::Component {
  kervan::Timer tick_{this, 20ms, &Watcher::on_tick};
  void on_tick(kervan::Time now) {
    times.push_back(now);
    if (times.size() == stop_after) finish("seen enough");
  }

 public:
  static inline std::vector<kervan::Time> times;
  static inline std::size_t stop_after = 0;
};

/// Publishes every 20 ms, for the first 100 ms after it has begun.
class Talker final : public kervan::Component {
  kervan::Output<Time> out_{this, "talk", kervan::qos::state, "Words."};
  kervan::Timer tick_{this, 20ms, &Talker::on_tick};
  int said_ = 0;
  void on_tick(kervan::Time) {
    if (++said_ <= 5) out_.publish(Time{});
  }
};

/// Ends the run when what it heard has become too old.
class Listener final : public kervan::Component {
  kervan::Input<Time> in_{this, "talk", kervan::qos::state.max_age(300ms), "Words."};
  kervan::Timer tick_{this, 10ms, &Listener::on_tick};
  bool heard_ = false;
  void on_tick(kervan::Time) {
    if (in_.latest())
      heard_ = true;
    else if (heard_)
      finish(in_.missing());
  }
};

/// Its timer takes longer than its period.
class Slow final : public kervan::Component {
  kervan::Timer tick_{this, 10ms, &Slow::on_tick};
  void on_tick(kervan::Time now) {
    times.push_back(now);
    const auto end = std::chrono::steady_clock::now() + 12ms;
    while (std::chrono::steady_clock::now() < end) {
    }
  }

 public:
  static inline std::vector<kervan::Time> times;
};

class SimClock : public testing::Test {
 protected:
  SimClock() {
    registry_.add(kervan::test::define<Ticker>("test/ticker"));
    registry_.add(kervan::test::define<Watcher>("test/watcher"));
    registry_.add(kervan::test::define<Talker>("test/talker"));
    registry_.add(kervan::test::define<Listener>("test/listener"));
    registry_.add(kervan::test::define<Slow>("test/slow"));
    Watcher::times.clear();
    Watcher::stop_after = 0;
    Slow::times.clear();
  }

  static ContainerSpec alone(double pace) {
    ContainerSpec spec;
    spec.clock = ClockMode::sim;
    spec.pace = pace;
    spec.domain = {.id = 211, .network = false};
    spec.log_to_console = false;
    spec.components.push_back({.name = "world", .type = "test/ticker"});
    return spec;
  }

  /// The container `name` of a composition whose simulator runs in the container `sim`. Domains of one process meet on
  /// loopback like processes.
  static ContainerSpec member(const std::string& name, unsigned id, double pace) {
    ContainerSpec spec = alone(pace);
    spec.name = name;
    spec.members = {"sim", "robot"};
    spec.domain = {.id = id, .tag = "kervan-sim-clock-test-" + std::to_string(getpid()), .external_id = 212};
    const kervan::QosProfile state = *kervan::builtin_profile("state");
    spec.components[0].container = "sim";
    spec.components[0].ports.push_back({.port = "/clock",
                                        .topic = "/clock",
                                        .profile = state,
                                        .direction = kervan::PortDirection::output,
                                        .type = "rosgraph_msgs::msg::Clock"});
    return spec;
  }

  void add(ContainerSpec& spec, const std::string& name, const std::string& type, const std::string& container) {
    spec.components.push_back({.name = name, .type = type, .container = container});
    if (type == "test/talker" || type == "test/listener")
      spec.components.back().ports.push_back(
          {.port = "talk",
           .topic = "/talk",
           .profile = *kervan::builtin_profile("state"),
           .direction = type == "test/talker" ? kervan::PortDirection::output : kervan::PortDirection::input,
           .type = "builtin_interfaces::msg::Time"});
  }

  kervan::ComponentRegistry registry_{{}};
};

TEST_F(SimClock, WithoutAPaceTimeJumpsFromTimerToTimer) {
  ContainerSpec spec = alone(0.0);
  spec.components.push_back({.name = "watcher", .type = "test/watcher"});
  Container container(spec, registry_);
  const auto report = container.run({.limit = 10min});
  EXPECT_EQ(report.end, RunEnd::time_limit) << report.reason;
  EXPECT_EQ(report.ended_at, kervan::Time(10min)) << "simulated time begins at 0, and the limit is kept exactly";
  ASSERT_EQ(Watcher::times.size(), 30'001u);
  for (std::size_t i = 0; i < Watcher::times.size(); ++i) ASSERT_EQ(Watcher::times[i], kervan::Time(i * 20ms));
}

TEST_F(SimClock, TimeWaitsForWhoeverIsTooSlowForIt) {
  ContainerSpec spec = alone(1000.0);
  spec.components.push_back({.name = "slow", .type = "test/slow"});
  Container container(spec, registry_);
  EXPECT_EQ(container.run({.limit = 200ms}).end, RunEnd::time_limit);
  ASSERT_EQ(Slow::times.size(), 21u);
  for (std::size_t i = 0; i < Slow::times.size(); ++i) EXPECT_EQ(Slow::times[i], kervan::Time(i * 10ms));
}

TEST_F(SimClock, AtAPaceItTakesAtLeastThatLong) {
  Container container(alone(20.0), registry_);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(container.run({.limit = 2s}).end, RunEnd::time_limit);
  EXPECT_GE(std::chrono::steady_clock::now() - start, 100ms);
}

TEST_F(SimClock, RunsInSeveralThreadsToo) {
  ContainerSpec spec = alone(0.0);
  spec.threads = 4;
  for (int i = 0; i < 8; ++i) spec.components.push_back({.name = "t" + std::to_string(i), .type = "test/ticker"});
  spec.components.push_back({.name = "watcher", .type = "test/watcher"});
  Watcher::stop_after = 500;
  Container container(spec, registry_);
  const auto report = container.run({});
  EXPECT_EQ(report.end, RunEnd::finished);
  ASSERT_EQ(Watcher::times.size(), 500u);
  for (std::size_t i = 0; i < Watcher::times.size(); ++i) ASSERT_EQ(Watcher::times[i], kervan::Time(i * 20ms));
}

TEST_F(SimClock, EndsWhenNothingWouldEverHappenAgain) {
  class Still final : public kervan::Component {
    kervan::Output<rosgraph_msgs::msg::Clock> clock_{this, "/clock", kervan::qos::state, "The time."};
  };
  registry_.add(kervan::test::define<Still>("test/still"));
  ContainerSpec spec = alone(1.0);
  spec.components[0].type = "test/still";
  Container container(spec, registry_);
  const auto report = container.run({});
  EXPECT_EQ(report.end, RunEnd::idle);
  EXPECT_EQ(report.reason, "no component has a timer, so nothing would ever happen again");
}

TEST_F(SimClock, AnotherContainerFollowsIt) {
  ContainerSpec sim = member("sim", 211, 20.0), robot = member("robot", 213, 20.0);
  for (ContainerSpec* spec : {&sim, &robot}) add(*spec, "watcher", "test/watcher", "robot");
  Watcher::stop_after = 100;
  Container master(sim, registry_), follower(robot, registry_);
  std::thread thread([&] { EXPECT_EQ(master.run({}).end, RunEnd::finished); });
  const auto report = follower.run({});
  thread.join();
  EXPECT_EQ(report.end, RunEnd::finished) << report.reason;
  ASSERT_GE(Watcher::times.size(), 100u);  // time goes on while the run ends
  for (std::size_t i = 0; i < Watcher::times.size(); ++i) {
    EXPECT_EQ(Watcher::times[i].time_since_epoch() % 10ms, 0ms) << "only times that /clock has named";
    if (i > 0) {
      EXPECT_GE(Watcher::times[i] - Watcher::times[i - 1], 20ms - 10ms);
    }
  }
  EXPECT_LE(report.ended_at, master.now());
}

TEST_F(SimClock, TheAgeOfWhatAnotherContainerSaidCountsInSimulatedTime) {
  ContainerSpec sim = member("sim", 211, 5.0), robot = member("robot", 213, 5.0);
  for (ContainerSpec* spec : {&sim, &robot}) {
    add(*spec, "talker", "test/talker", "sim");
    add(*spec, "listener", "test/listener", "robot");
  }
  Container follower(robot, registry_), master(sim, registry_);
  std::thread thread([&] { master.run({}); });
  const auto report = follower.run({});
  thread.join();
  EXPECT_EQ(report.reason, "talk: no sample for more than 0.30 s");
}

TEST_F(SimClock, WhoFollowsAClockThatStopsSaysWhoWroteIt) {
  ContainerSpec sim = member("sim", 211, 1.0), robot = member("robot", 213, 1.0);
  for (ContainerSpec* spec : {&sim, &robot}) add(*spec, "watcher", "test/watcher", "robot");
  Container follower(robot, registry_);
  std::thread thread([&] {
    Container master(sim, registry_);
    master.run({.limit = 200ms});
  });
  const auto report = follower.run({});
  thread.join();
  EXPECT_EQ(report.end, RunEnd::clock_lost);
  EXPECT_EQ(report.reason, "/clock stands still: nothing came from world in container sim for 2 s");
}

TEST_F(SimClock, AClockThatNeverComesIsMissed) {
  ContainerSpec robot = member("robot", 213, 0.0);
  add(robot, "watcher", "test/watcher", "robot");
  robot.components.erase(robot.components.begin());
  robot.members.clear();  // nobody to be matched with: only the time is missing
  Container follower(robot, registry_);
  const auto report = follower.run({});
  EXPECT_EQ(report.end, RunEnd::clock_lost);
  EXPECT_EQ(report.reason, "/clock stands still: nothing came for 10 s");
  EXPECT_TRUE(Watcher::times.empty()) << "nobody was activated";
}

TEST_F(SimClock, WaitingForTheFirstTimeCanBeInterrupted) {
  ContainerSpec robot = member("robot", 213, 1.0);
  add(robot, "watcher", "test/watcher", "robot");
  robot.members.clear();
  Container follower(robot, registry_);
  const std::atomic<bool> stop{true};
  EXPECT_EQ(follower.run({.stop = &stop}).end, RunEnd::interrupted);
}

}  // namespace
