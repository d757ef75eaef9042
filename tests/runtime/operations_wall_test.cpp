/// What can be asked of a container while its dispatchers run. Nothing here asserts how long anything takes.
#include <gtest/gtest.h>

#include <fstream>
#include <future>
#include <optional>
#include <thread>

#include "framework/dds/statistics.hpp"
#include "framework/runtime/container.hpp"
#include "framework/runtime/operations.hpp"
#include "tests/runtime/operations_fixtures.hpp"

namespace {

using namespace std::chrono_literals;
using namespace kervan::test::operations;
using kervan::ComponentState;
using kervan::runtime::Container;
using kervan::runtime::Operations;
using kervan::runtime::Outcome;
using kervan::runtime::RunEnd;

/// Counts its ticks; asks for a thread of its own if it is told to.
struct TickerParams {
  bool own_thread = false;
  std::int64_t step = 1;
  template <class Visitor>
  void describe(Visitor& v) {
    v(own_thread, "own_thread", {.help = "In a thread of its own."});
    v(step, "step", {.min = 0, .max = 10, .help = "Added at each tick.", .live = true});
  }
};

class Ticker final : public kervan::Component {
  const TickerParams& params_ = parameters<TickerParams>();
  kervan::Input<Words> in_{this, "in", kervan::qos::event.optional(), &Ticker::on_words, "Handled too."};
  kervan::Output<Words> out_{this, "out", kervan::qos::event, "A word at each tick."};
  kervan::Timer tick_{this, 1ms, &Ticker::on_tick};
  std::atomic<int> inside_{0};
  std::int64_t seen_step_ = params_.step;

  void enter() { EXPECT_EQ(inside_.fetch_add(1), 0) << "two threads in one component"; }
  void leave() { --inside_; }
  void on_parameters_changed() override {
    enter();
    seen_step_ = params_.step;
    leave();
  }
  void on_words(const Words&, kervan::Time) {
    enter();
    leave();
  }
  void on_tick(kervan::Time) {
    enter();
    EXPECT_EQ(seen_step_, params_.step);
    out_.publish(Words{});
    ticks += static_cast<int>(params_.step);
    leave();
  }
  void on_activate(kervan::Time) override { ++activations; }
  void on_deactivate(kervan::Time) override {
    enter();
    ++deactivations;
    leave();
  }

 public:
  Ticker() {
    if (params_.own_thread) wants_own_thread();
    ++alive;
  }
  ~Ticker() override { --alive; }
  static inline std::atomic<int> alive = 0, ticks = 0, activations = 0, deactivations = 0;
};

/// A container that runs in a thread of its own until the test is over, and a way to ask it.
class Running {
 public:
  explicit Running(unsigned threads, std::uint32_t domain) {
    registry.add(kervan::test::define<Ticker>("test/ticker"));
    auto spec = operations_spec();
    spec.threads = threads;
    spec.domain.id = domain;
    spec.components.push_back({.name = "ticker", .type = "test/ticker"});
    container.emplace(spec, registry);
    thread_ = std::thread([this] { end = container->run({.stop = &stop_}).end; });
  }
  ~Running() {
    stop_ = true;
    thread_.join();
    EXPECT_EQ(end, RunEnd::interrupted);
  }

  /// Has the container do it, and waits for what came of it.
  template <class Work>
  auto ask(Work&& work) {
    std::promise<decltype(work(container->operations()))> done;
    container->operations().post([&] { done.set_value(work(container->operations())); });
    return done.get_future().get();
  }
  std::string load(const std::string& name, bool own_thread = false) {
    return ask([&](Operations& operations) {
      const Outcome outcome =
          operations.load({.name = name, .type = "test/ticker", .parameters = {{"own_thread", own_thread}}});
      return outcome.accepted ? "yes" : outcome.reason;
    });
  }
  std::string unload(const std::string& name) {
    return ask([&](Operations& operations) {
      const Outcome outcome = operations.unload(name);
      return outcome.accepted ? "yes" : outcome.reason;
    });
  }

  kervan::ComponentRegistry registry = operations_registry();
  std::optional<Container> container;
  RunEnd end = RunEnd::finished;

 private:
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

void wait_for_ticks(int count) {
  const int from = Ticker::ticks;
  while (Ticker::ticks < from + count) std::this_thread::yield();
}

class WallOperations : public ::testing::TestWithParam<unsigned> {};

TEST_P(WallOperations, ComponentsComeAndGoWhileTheOthersRun) {
  Running running(GetParam(), 235);
  for (int round = 0; round < 20; ++round) {
    EXPECT_EQ(running.load("extra", round % 2 == 1), "yes");
    EXPECT_EQ(Ticker::alive, 2);
    wait_for_ticks(3);
    EXPECT_EQ(running.unload("extra"), "yes");
    EXPECT_EQ(Ticker::alive, 1);
  }
  EXPECT_EQ(Ticker::activations, Ticker::deactivations + 1);
}

TEST_P(WallOperations, AComponentIsStoppedAndStartedAgain) {
  Running running(GetParam(), 236);
  for (int round = 0; round < 20; ++round) {
    EXPECT_TRUE(running.ask([](Operations& operations) { return operations.deactivate("ticker").accepted; }));
    const int before = Ticker::ticks;
    EXPECT_EQ(Ticker::ticks, before);
    EXPECT_TRUE(running.ask([](Operations& operations) { return operations.activate("ticker").accepted; }));
    wait_for_ticks(2);
  }
}

TEST_P(WallOperations, ParametersChangeBetweenHandlers) {
  Running running(GetParam(), 237);
  for (std::int64_t step = 1; step <= 10; ++step) {
    EXPECT_EQ(running.ask([&](Operations& operations) {
      return operations.change_parameters("ticker", {{"step", step}}).reason;
    }),
              "");
    wait_for_ticks(1);
  }
  EXPECT_EQ(running.ask([](Operations& operations) {
    return operations.change_parameters("ticker", {{"step", std::int64_t{11}}}).reason;
  }),
            "step: 11 is out of range; allowed: 0 .. 10");
}

INSTANTIATE_TEST_SUITE_P(Threads, WallOperations, ::testing::Values(1u, 2u, 4u));

TEST(WallOperationsHang, AComponentThatDoesNotComeBackIsLeftAsItIsAndTheOthersRunOn) {
  Slow::stay = true;
  Slow::inside = false;
  {
    Running running(2, 238);
    running.ask([](Operations& operations) { return operations.load({.name = "slow", .type = "test/slow"}).accepted; });
    while (!Slow::inside) std::this_thread::yield();
    const std::string why = running.ask([](Operations& operations) {
      operations.set_patience(50ms);
      return operations.unload("slow").reason;
    });
    EXPECT_TRUE(why.starts_with("'slow' has been in a handler for ")) << why;
    EXPECT_TRUE(why.ends_with(" s and did not come back")) << why;
    wait_for_ticks(3);
    EXPECT_NE(running.ask([](Operations& operations) { return operations.known_components(""); }).find("slow"),
              std::string::npos);
    Slow::stay = false;
    EXPECT_EQ(running.ask([](Operations& operations) {
      operations.set_patience(60s);
      return operations.unload("slow").reason;
    }),
              "");
  }
}

/// A sanitizer holds freed memory back, so that a process grows without a leak; AddressSanitizer finds leaks itself.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kResidentTellsLeaks = false;
#else
constexpr bool kResidentTellsLeaks = true;
#endif

/// Resident memory of this process in kB.
long resident() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmRSS:") {
      long kilobytes = 0;
      status >> kilobytes;
      return kilobytes;
    }
  return 0;
}

TEST(WallOperationsLeak, LoadingAndUnloadingAHundredTimesLeavesNothingBehind) {
  Running running(1, 239);
  const auto round = [&](int i) {
    ASSERT_EQ(running.load("extra" + std::to_string(i % 3), i % 2 == 1), "yes");
    ASSERT_EQ(running.unload("extra" + std::to_string(i % 3)), "yes");
  };
  const char* const rounds_text = std::getenv("KERVAN_LOAD_ROUNDS");
  const int rounds = rounds_text ? std::atoi(rounds_text) : 100;
  for (int i = 0; i < rounds / 2; ++i) round(i);
  const long before = resident();
  for (int i = 0; i < rounds / 2; ++i) round(i);
  const long grown = resident() - before;
  RecordProperty("resident_before_kB", static_cast<int>(before));
  RecordProperty("grown_kB", static_cast<int>(grown));
  EXPECT_EQ(Ticker::alive, 1);
  EXPECT_EQ(running.container->instances().size(), 4u);
  if (kResidentTellsLeaks) {
    EXPECT_LT(grown, 4096) << rounds / 2 << " rounds, from " << before << " kB";
  }
}

}  // namespace
