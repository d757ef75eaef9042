/// Keyed topics: instances come, are told apart, and go.
#include <gtest/gtest.h>

#include "framework/kervan.hpp"
#include "framework/runtime/container.hpp"
#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"

namespace {

using namespace std::chrono_literals;
using kervan_msgs::msg::MotionRequest;

MotionRequest request(const std::string& behaviour, int priority) {
  MotionRequest message;
  message.behaviour = behaviour;
  message.priority = priority;
  return message;
}

/// Publishes two behaviours; ends the life of the first in the third period.
class Behaviours final : public kervan::Component {
  kervan::Output<MotionRequest> out_{this, "requests", kervan::qos::state, "One instance a behaviour."};
  kervan::Timer tick_{this, 100ms, &Behaviours::on_tick};
  int ticks_ = 0;

  void on_tick(kervan::Time) {
    ++ticks_;
    if (ticks_ < 3) out_.publish(request("wall_follow", ticks_));
    if (ticks_ == 3) out_.dispose(request("wall_follow", 0));
    out_.publish(request("stall", 10 * ticks_));
  }
};

/// Looks at all instances once a period, and at the samples in between with a handler.
class Arbiter final : public kervan::Component {
  kervan::Input<MotionRequest> in_{this, "requests", kervan::qos::state, "Looked at."};
  kervan::Input<MotionRequest> handled_{this, "handled", kervan::qos::state, &Arbiter::on_request, "Handled."};
  kervan::Timer tick_{this, 100ms, &Arbiter::on_tick};

  void on_request(const kervan::Sample<MotionRequest>& sample, kervan::Time) {
    if (sample.disposed()) disposed.push_back(sample->behaviour);
  }
  void on_tick(kervan::Time) {
    std::string line;
    for (const auto& sample : in_.instances()) line += sample->behaviour + "=" + std::to_string(sample->priority) + " ";
    seen.push_back(line);
  }

 public:
  static inline std::vector<std::string> seen;
  static inline std::vector<std::string> disposed;
};

TEST(KeyedTopic, ShowsTheNewestSampleOfEachInstanceUntilItIsDisposedOf) {
  kervan::ComponentRegistry registry({});
  registry.add(kervan::test::define<Behaviours>("test/behaviours"));
  registry.add(kervan::test::define<Arbiter>("test/arbiter"));
  kervan::runtime::ContainerSpec spec;
  spec.clock = kervan::runtime::ClockMode::lockstep;
  spec.domain = {.id = 208, .network = false};
  spec.log_to_console = false;
  const kervan::QosProfile state = *kervan::builtin_profile("state");
  spec.components.push_back({.name = "behaviours", .type = "test/behaviours"});
  spec.components.push_back({.name = "arbiter",
                             .type = "test/arbiter",
                             .ports = {{"requests", "/requests", state}, {"handled", "/requests", state}}});
  kervan::runtime::Container container(spec, registry);
  container.run({.limit = 400ms});
  EXPECT_EQ(Arbiter::seen, (std::vector<std::string>{"", "wall_follow=1 stall=10 ", "wall_follow=2 stall=20 ",
                                                     "stall=30 ", "stall=40 "}));
  EXPECT_EQ(Arbiter::disposed, (std::vector<std::string>{"wall_follow"}));
}

/// A new instance every period, disposed of in the next: the cache must not keep what is gone.
class Comings final : public kervan::Component {
  kervan::Output<MotionRequest> out_{this, "requests", kervan::qos::state, "One instance a period."};
  kervan::Timer tick_{this, 1ms, &Comings::on_tick};
  int ticks_ = 0;

  void on_tick(kervan::Time) {
    if (ticks_ > 0) out_.dispose(request(std::to_string(ticks_ - 1), 0));
    out_.publish(request(std::to_string(ticks_), ticks_));
    ++ticks_;
  }
};

class Goings final : public kervan::Component {
  kervan::Input<MotionRequest> in_{this, "requests", kervan::qos::state, "Looked at."};
  kervan::Timer tick_{this, 1ms, &Goings::on_tick};
  void on_tick(kervan::Time) { most = std::max(most, in_.instances().size()); }

 public:
  static inline std::size_t most = 0;
};

TEST(KeyedTopic, ForgetsThousandsOfInstancesThatWereDisposedOf) {
  kervan::ComponentRegistry registry({});
  registry.add(kervan::test::define<Comings>("test/comings"));
  registry.add(kervan::test::define<Goings>("test/goings"));
  kervan::runtime::ContainerSpec spec;
  spec.clock = kervan::runtime::ClockMode::lockstep;
  spec.domain = {.id = 209, .network = false};
  spec.log_to_console = false;
  spec.components.push_back({.name = "comings", .type = "test/comings"});
  spec.components.push_back({.name = "goings", .type = "test/goings"});
  kervan::runtime::Container container(spec, registry);
  container.run({.limit = 5s});
  EXPECT_EQ(Goings::most, 1u);
  EXPECT_LT(container.find("goings")->inputs().front()->cache().remembered_instances(), 64u);
}

}  // namespace
