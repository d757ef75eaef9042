/// Manual liveliness and partitions between components, on logical time and on the wall clock.
#include <gtest/gtest.h>

#include "builtin_interfaces/msg/Time.hpp"
#include "framework/kervan.hpp"
#include "framework/runtime/container.hpp"
#include "framework/test/harness.hpp"

namespace {

using namespace std::chrono_literals;
using builtin_interfaces::msg::Time;
using kervan::Liveliness;
using kervan::runtime::ClockMode;

/// Publishes for 100 ms, asserts for another 200 ms, then is silent until 500 ms.
class Guard final : public kervan::Component {
  kervan::Output<Time> out_{this, "out", kervan::qos::event, "Sign of life."};
  kervan::Timer tick_{this, 20ms, &Guard::on_tick};
  kervan::Time start_{};
  int count_ = 0;

  void on_activate(kervan::Time now) override { start_ = now; }
  void on_tick(kervan::Time) {
    if (++count_ <= 5) {
      auto message = out_.loan();
      message->sec = count_;
      out_.publish(std::move(message));
    } else if (count_ <= 15) {
      out_.assert_alive();
    } else if (count_ == 25) {
      finish("said everything");
    }
  }
};

class Listener final : public kervan::Component {
  kervan::Input<Time> in_{this, "in", kervan::qos::event, &Listener::on_message, "Sign of life."};
  void on_message(const Time& message, kervan::Time) { heard.push_back(message.sec); }

 public:
  static inline std::vector<int> heard;
};

kervan::QosProfile manual(kervan::Duration lease) {
  kervan::QosProfile profile = *kervan::builtin_profile("event");
  profile.liveliness = Liveliness::manual;
  profile.lease = lease;
  return profile;
}

kervan::runtime::ContainerSpec spec_of(ClockMode clock, std::uint32_t domain) {
  kervan::runtime::ContainerSpec spec;
  spec.clock = clock;
  spec.domain = {.id = domain, .network = false};
  spec.log_to_console = false;
  return spec;
}

struct Parts {
  kervan::ComponentRegistry registry{{}};
  kervan::ComponentClass guard = kervan::test::define<Guard>("test/guard");
  kervan::ComponentClass listener = kervan::test::define<Listener>("test/listener");
  Parts() {
    registry.add(guard);
    registry.add(listener);
    Listener::heard.clear();
  }
};

class Lease : public ::testing::TestWithParam<ClockMode> {};

TEST_P(Lease, EndsWhenAWriterNeitherPublishesNorAsserts) {
  Parts parts;
  auto spec = spec_of(GetParam(), 212);
  // Wall clock: the lease is far longer than any delay of this machine, and the writer ends within it.
  const kervan::QosProfile profile = manual(GetParam() == ClockMode::wall ? kervan::Duration(30s) : 150ms);
  spec.components.push_back({.name = "guard", .type = "test/guard", .ports = {{"out", "/alive", profile}}});
  spec.components.push_back({.name = "listener", .type = "test/listener", .ports = {{"in", "/alive", profile}}});
  kervan::runtime::Container container(spec, parts.registry);
  EXPECT_EQ(container.run({.limit = 60s}).reason, "said everything");
  EXPECT_EQ(Listener::heard, (std::vector{1, 2, 3, 4, 5})) << "an assertion is no sample";
  const auto counters = container.find("listener")->inputs().front()->counters();
  EXPECT_EQ(counters.received, 5u);
  // Last asserted at 300 ms, silent until 480 ms.
  EXPECT_EQ(counters.liveliness_lost, GetParam() == ClockMode::wall ? 0u : 1u);
}

INSTANTIATE_TEST_SUITE_P(Clocks, Lease, ::testing::Values(ClockMode::wall, ClockMode::lockstep),
                         [](const auto& clock) { return clock.param == ClockMode::wall ? "wall" : "lockstep"; });

/// Under the wall clock Cyclone watches the lease. The reader waits for the loss, however late it is told.
class Waiting final : public kervan::Component {
  kervan::Input<Time> in_{this, "in", kervan::qos::event, &Waiting::on_message, "Sign of life."};
  kervan::Output<Time> once_{this, "once", kervan::qos::event, "One sample."};
  kervan::Timer tick_{this, 20ms, &Waiting::on_tick};
  void on_activate(kervan::Time) override { once_.publish(Time{}); }
  void on_message(const Time&, kervan::Time) {}
  void on_tick(kervan::Time) {
    if (lost && lost()) finish("lost");
  }

 public:
  static inline std::function<bool()> lost;
};

TEST(LeaseOnTheWallClock, OfASilentWriterEndsAndIsCounted) {
  kervan::ComponentRegistry registry({});
  registry.add(kervan::test::define<Waiting>("test/waiting"));
  auto spec = spec_of(ClockMode::wall, 213);
  const kervan::QosProfile profile = manual(50ms);
  spec.components.push_back(
      {.name = "waiting", .type = "test/waiting", .ports = {{"in", "/alive", profile}, {"once", "/alive", profile}}});
  kervan::runtime::Container container(spec, registry);
  const kervan::runtime::InputPort& input = *container.find("waiting")->inputs().front();
  Waiting::lost = [&] { return input.cache().counters().liveliness_lost == 1; };
  EXPECT_EQ(container.run({.limit = 60s}).reason, "lost");
  Waiting::lost = nullptr;
}

class Partition : public ::testing::TestWithParam<ClockMode> {};

TEST_P(Partition, SeparatesEndpointsOfOneTopic) {
  Parts parts;
  auto spec = spec_of(GetParam(), 214);
  kervan::QosProfile left = *kervan::builtin_profile("event");
  kervan::QosProfile right = left;
  kervan::QosProfile every = left;
  left.partition = {"left"};
  right.partition = {"right"};
  every.partition = {"*t"};
  spec.components.push_back({.name = "guard", .type = "test/guard", .ports = {{"out", "/alive", left}}});
  spec.components.push_back({.name = "same", .type = "test/listener", .ports = {{"in", "/alive", left}}});
  spec.components.push_back({.name = "other", .type = "test/listener", .ports = {{"in", "/alive", right}}});
  spec.components.push_back({.name = "pattern", .type = "test/listener", .ports = {{"in", "/alive", every}}});
  kervan::runtime::Container container(spec, parts.registry);
  container.run({.limit = 60s});
  const auto received = [&](const char* name) { return container.find(name)->inputs().front()->counters().received; };
  EXPECT_EQ(received("same"), 5u);
  EXPECT_EQ(received("other"), 0u);
  EXPECT_EQ(received("pattern"), 5u);
}

INSTANTIATE_TEST_SUITE_P(Clocks, Partition, ::testing::Values(ClockMode::wall, ClockMode::lockstep),
                         [](const auto& clock) { return clock.param == ClockMode::wall ? "wall" : "lockstep"; });

/// Two writers of different strength: the stronger one alone is heard, also where DDS only carries.
class Voice final : public kervan::Component {
  kervan::Output<Time> out_;
  kervan::Timer tick_{this, 20ms, &Voice::on_tick};
  int strength_;
  int count_ = 0;
  void on_tick(kervan::Time) {
    auto message = out_.loan();
    message->sec = strength_;
    out_.publish(std::move(message));
    if (++count_ == 10) finish("enough");
  }

 public:
  Voice()
      : out_(this, "out", kervan::qos::event.strength(name() == "strong" ? 9 : 1), "Who speaks."),
        strength_(name() == "strong" ? 9 : 1) {}
};

TEST(Ownership, GoesToTheStrongerWriterUnderLockstepToo) {
  kervan::ComponentRegistry registry({});
  registry.add(kervan::test::define<Voice>("test/voice"));
  registry.add(kervan::test::define<Listener>("test/listener"));
  Listener::heard.clear();
  auto spec = spec_of(ClockMode::lockstep, 215);
  kervan::QosProfile profile = *kervan::builtin_profile("event");
  profile.ownership = kervan::Ownership::exclusive;
  spec.components.push_back({.name = "weak", .type = "test/voice", .ports = {{"out", "/voice", profile}}});
  spec.components.push_back({.name = "strong", .type = "test/voice", .ports = {{"out", "/voice", profile}}});
  spec.components.push_back({.name = "listener", .type = "test/listener", .ports = {{"in", "/voice", profile}}});
  kervan::runtime::Container container(spec, registry);
  container.run({.limit = 60s});
  ASSERT_EQ(Listener::heard.size(), 11u);  // the weak one owned the topic until the strong one spoke
  EXPECT_EQ(Listener::heard.front(), 1);
  for (std::size_t i = 1; i < Listener::heard.size(); ++i) EXPECT_EQ(Listener::heard[i], 9);
}

}  // namespace
