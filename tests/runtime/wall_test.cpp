/// The wall clock's dispatcher. Nothing here asserts how long anything takes.
#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <thread>

#include "builtin_interfaces/msg/Time.hpp"
#include "framework/dds/statistics.hpp"
#include "framework/kervan.hpp"
#include "framework/runtime/container.hpp"
#include "framework/test/harness.hpp"

namespace {

using namespace std::chrono_literals;
using builtin_interfaces::msg::Time;

/// Passes a counter round a ring and ends the run when it is high enough.
class Relay final : public kervan::Component {
  kervan::Input<Time> in_{this, "in", kervan::qos::event, &Relay::on_message, "Counter in."};
  kervan::Output<Time> out_{this, "out", kervan::qos::event, "Counter out."};
  std::atomic<int> inside_{0};

  void on_activate(kervan::Time) override {
    if (name() == "relay0") out_.publish(Time{});
  }
  void on_message(const Time& message, kervan::Time) {
    EXPECT_EQ(inside_.fetch_add(1), 0) << "two handlers of one component at once";
    if (message.sec == 3000) {
      finish("far enough");
    } else {
      auto next = out_.loan();
      next->sec = message.sec + 1;
      out_.publish(std::move(next));
    }
    inside_ = 0;
  }
};

class Blocking final : public kervan::Component {
  kervan::Input<Time> in_{this, "in", kervan::qos::state, &Blocking::on_message, "Work."};
  kervan::Output<Time> out_{this, "out", kervan::qos::state, "Done."};
  void on_message(const Time& message, kervan::Time) {
    if (thread == std::thread::id())
      thread = std::this_thread::get_id();  // later ones may belong to the end of the run
    out_.publish(message);
  }

 public:
  Blocking() { wants_own_thread(); }
  static inline std::thread::id thread;
};

class Boss final : public kervan::Component {
  kervan::Input<Time> done_{this, "done", kervan::qos::state, &Boss::on_done, "Done."};
  kervan::Output<Time> work_{this, "work", kervan::qos::state, "Work."};
  kervan::Timer tick_{this, 5ms, &Boss::on_tick};
  void on_tick(kervan::Time) { work_.publish(Time{}); }
  void on_done(const Time&, kervan::Time) {
    if (thread == std::thread::id()) thread = std::this_thread::get_id();
    finish("the work is done");
  }

 public:
  static inline std::thread::id thread;
};

class Twice final : public kervan::Component {
  kervan::Output<Time> out_{this, "out", kervan::qos::event, "Two at once."};
  void on_activate(kervan::Time) override {
    out_.publish(Time{});
    out_.publish(Time{});
  }
};

constexpr auto kOld = 100ms;

/// Works longer on the first message than the second one may be old.
class Slow final : public kervan::Component {
  kervan::Input<Time> in_{this, "in", kervan::qos::event.max_age(kOld), &Slow::on_message, "Not too old."};
  kervan::Input<Time> any_{this, "any", kervan::qos::event, &Slow::on_any, "Of any age."};
  int heard_ = 0;
  void on_message(const Time&, kervan::Time) {
    if (heard_++ == 0) std::this_thread::sleep_for(2 * kOld);
  }
  void on_any(const Time&, kervan::Time) {
    if (++heard_ == 4) finish("heard everything");
  }
};

class WallClock : public ::testing::TestWithParam<unsigned> {};

TEST_P(WallClock, RunsARingUntilAComponentFinishes) {
  kervan::ComponentRegistry registry({});
  const auto relay = kervan::test::define<Relay>("test/relay");
  registry.add(relay);
  kervan::runtime::ContainerSpec spec;
  spec.threads = GetParam();
  spec.domain = {.id = 205, .network = false};
  spec.log_to_console = false;
  const kervan::QosProfile event = *kervan::builtin_profile("event");
  for (int i = 0; i < 5; ++i)
    spec.components.push_back({.name = "relay" + std::to_string(i),
                               .type = relay.type,
                               .ports = {{"in", "/relay" + std::to_string((i + 4) % 5), event},
                                         {"out", "/relay" + std::to_string(i), event}}});
  const auto before = kervan::dds::data_path_statistics();
  kervan::runtime::Container container(spec, registry);
  const auto report = container.run({.limit = 60s});
  EXPECT_EQ(report.end, kervan::runtime::RunEnd::finished) << report.reason;
  EXPECT_EQ(report.reason, "far enough");
  EXPECT_EQ(kervan::dds::data_path_statistics().serialised, before.serialised);
}

INSTANTIATE_TEST_SUITE_P(Threads, WallClock, ::testing::Values(1u, 2u, 4u));

TEST(WallClockOwnThread, AComponentThatBlocksRunsInAThreadOfItsOwn) {
  kervan::ComponentRegistry registry({});
  const auto blocking = kervan::test::define<Blocking>("test/blocking");
  const auto boss = kervan::test::define<Boss>("test/boss");
  registry.add(blocking);
  registry.add(boss);
  kervan::runtime::ContainerSpec spec;
  spec.domain = {.id = 206, .network = false};
  spec.log_to_console = false;
  const kervan::QosProfile state = *kervan::builtin_profile("state");
  spec.components.push_back(
      {.name = "blocking", .type = blocking.type, .ports = {{"in", "/work", state}, {"out", "/done", state}}});
  spec.components.push_back(
      {.name = "boss", .type = boss.type, .ports = {{"work", "/work", state}, {"done", "/done", state}}});
  kervan::runtime::Container container(spec, registry);
  EXPECT_EQ(container.run({.limit = 60s}).end, kervan::runtime::RunEnd::finished);
  EXPECT_NE(Blocking::thread, Boss::thread);
}

/// Works on a sample until the next one is there.
class Interruptible final : public kervan::Component {
  kervan::Input<Time> in_{this, "in", kervan::qos::state, &Interruptible::on_message, "Work."};
  kervan::Output<Time> out_{this, "out", kervan::qos::state, "Done."};
  void on_message(const Time& message, kervan::Time) {
    EXPECT_FALSE(lockstep());
    if (interrupted) return;
    const auto watchdog = std::chrono::steady_clock::now() + 50s;
    while (!in_.waiting() && std::chrono::steady_clock::now() < watchdog) std::this_thread::yield();
    interrupted = in_.waiting();
    out_.publish(message);
  }

 public:
  Interruptible() { wants_own_thread(); }
  static inline std::atomic<bool> interrupted = false;
};

TEST(WallClockOwnThread, AHandlerSeesThatSomethingNewerHasCome) {
  kervan::ComponentRegistry registry({});
  const auto interruptible = kervan::test::define<Interruptible>("test/interruptible");
  const auto boss = kervan::test::define<Boss>("test/boss");
  registry.add(interruptible);
  registry.add(boss);
  kervan::runtime::ContainerSpec spec;
  spec.domain = {.id = 206, .network = false};
  spec.log_to_console = false;
  const kervan::QosProfile state = *kervan::builtin_profile("state");
  spec.components.push_back({.name = "interruptible",
                             .type = interruptible.type,
                             .ports = {{"in", "/work", state}, {"out", "/done", state}}});
  spec.components.push_back(
      {.name = "boss", .type = boss.type, .ports = {{"work", "/work", state}, {"done", "/done", state}}});
  kervan::runtime::Container container(spec, registry);
  EXPECT_EQ(container.run({.limit = 60s}).end, kervan::runtime::RunEnd::finished);
  EXPECT_TRUE(Interruptible::interrupted);
}

/// Publishes far more than its reader's inbox holds, from within one handler.
class Flood final : public kervan::Component {
  kervan::Output<Time> out_{this, "out", kervan::qos::event, "Many."};
  void on_activate(kervan::Time) override {
    for (int i = 0; i < 5000; ++i) {
      auto message = out_.loan();
      message->sec = i;
      out_.publish(std::move(message));
    }
  }
};

class Drain final : public kervan::Component {
  kervan::Input<Time> in_{this, "in", kervan::qos::event, &Drain::on_message, "Many."};
  void on_message(const Time& message, kervan::Time) {
    seen.push_back(message.sec);
    if (message.sec == 4999) finish("the last one came");
  }

 public:
  static inline std::vector<int> seen;
};

TEST(WallClockOverload, AComponentThatCannotKeepUpGetsTheNewestAndTheRestIsCounted) {
  kervan::ComponentRegistry registry({});
  registry.add(kervan::test::define<Flood>("test/flood"));
  registry.add(kervan::test::define<Drain>("test/drain"));
  kervan::runtime::ContainerSpec spec;
  spec.domain = {.id = 210, .network = false};
  spec.log_to_console = false;
  const kervan::QosProfile event = *kervan::builtin_profile("event");
  spec.components.push_back({.name = "flood", .type = "test/flood", .ports = {{"out", "/flood", event}}});
  spec.components.push_back({.name = "drain", .type = "test/drain", .ports = {{"in", "/flood", event}}});
  kervan::runtime::Container container(spec, registry);
  EXPECT_EQ(container.run({.limit = 60s}).end, kervan::runtime::RunEnd::finished);
  ASSERT_EQ(Drain::seen.size(), 100u);  // the depth of `event`
  EXPECT_EQ(Drain::seen.front(), 4900);
  EXPECT_EQ(Drain::seen.back(), 4999);
  const auto counters = container.find("drain")->inputs().front()->counters();
  EXPECT_EQ(counters.handled + counters.overwritten + counters.refused, 5000u);
}

TEST(WallClockStop, TheStopFlagEndsARunInGoodOrder) {
  kervan::ComponentRegistry registry({});
  const auto boss = kervan::test::define<Boss>("test/boss");
  registry.add(boss);
  kervan::runtime::ContainerSpec spec;
  spec.domain = {.id = 207, .network = false};
  spec.log_to_console = false;
  spec.components.push_back({.name = "boss", .type = boss.type});
  kervan::runtime::Container container(spec, registry);
  const std::atomic<bool> stop{true};
  EXPECT_EQ(container.run({.stop = &stop}).end, kervan::runtime::RunEnd::interrupted);
  EXPECT_EQ(container.instances().front()->state(), kervan::ComponentState::stopped);
}

TEST(Wall, WhatIsHandledTooLateIsCountedByThePortThatMinds) {
  kervan::ComponentRegistry registry({});
  registry.add(kervan::test::define<Twice>("test/twice"));
  registry.add(kervan::test::define<Slow>("test/slow"));
  kervan::runtime::ContainerSpec spec;
  spec.domain = {.id = 209, .network = false};
  spec.log_to_console = false;
  const kervan::QosProfile event = *kervan::builtin_profile("event");
  const auto in = kervan::PortDirection::input, out = kervan::PortDirection::output;
  spec.components = {
      {.name = "twice", .type = "test/twice", .ports = {{"out", "/numbers", event, out}}},
      {.name = "slow", .type = "test/slow", .ports = {{"in", "/numbers", event, in}, {"any", "/numbers", event, in}}}};
  kervan::runtime::Container container(spec, registry);
  EXPECT_EQ(container.run({.limit = 60s}).end, kervan::runtime::RunEnd::finished);
  const auto& inputs = container.find("slow")->inputs();
  ASSERT_EQ(inputs.size(), 2u);
  EXPECT_EQ(inputs[0]->counters().handled, 2u);
  EXPECT_GE(inputs[0]->counters().late, 1u);
  EXPECT_GE(inputs[0]->counters().worst_latency, 2 * kOld);
  EXPECT_EQ(inputs[1]->counters().handled, 2u);
  EXPECT_EQ(inputs[1]->counters().late, 0u);
}

}  // namespace
