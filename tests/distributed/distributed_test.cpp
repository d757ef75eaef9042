/// Lockstep in several containers: the same trace wherever the components run, and an end for all when one is lost.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cinttypes>
#include <cstdio>
#include <deque>
#include <mutex>
#include <thread>

#include "framework/component/error.hpp"
#include "framework/component/sample.hpp"
#include "framework/dds/endpoint.hpp"
#include "kervan_msgs/msg/Fence.hpp"
#include "sensor_msgs/msg/Range.hpp"
#include "tests/conformance/wire/peer.hpp"
#include "tests/distributed/stations.hpp"
#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using runtime::ContainerSpec;
using runtime::RunControl;
using runtime::RunEnd;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

constexpr unsigned kWatchdogSeconds = 110;

/// All containers of a run, each in a thread of its own.
std::vector<MemberResult> run_in_threads(const std::vector<ContainerSpec>& specs,
                                         const std::vector<RunControl>& controls) {
  std::vector<MemberResult> results(specs.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < specs.size(); ++i)
    threads.emplace_back([&, i] { results[i] = run_member(specs[i], controls[i]); });
  for (std::thread& thread : threads) thread.join();
  return results;
}

std::vector<MemberResult> run_in_threads(const std::vector<ContainerSpec>& specs, const RunControl& control) {
  return run_in_threads(specs, std::vector<RunControl>(specs.size(), control));
}

std::vector<ContainerSpec> all_of(std::uint64_t seed, const Placement& placement) {
  const std::string tag = new_tag();
  std::vector<ContainerSpec> specs;
  for (unsigned i = 0; i < placement.containers; ++i) specs.push_back(stations(seed, placement, i, tag));
  return specs;
}

/// The trace that all members agree on; 0 with a failure if they do not, or if the run did not last until its limit.
std::uint64_t trace_of(std::uint64_t seed, const Placement& placement, Duration limit = 300ms) {
  const std::vector<MemberResult> results = run_in_threads(all_of(seed, placement), {.limit = limit});
  for (const MemberResult& result : results) {
    EXPECT_EQ(result.report.end, RunEnd::time_limit) << result.report.reason;
    EXPECT_EQ(result.report.ended_at, Time{} + limit);
    EXPECT_EQ(result.trace, results.front().trace);
    EXPECT_EQ(result.failures, "");
    EXPECT_GT(result.report.cycles, 100u);
  }
  return ::testing::Test::HasFailure() ? 0 : results.front().trace;
}

class Seeds : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(Seeds, GiveTheSameTraceInAnyNumberOfContainersAndThreads) {
  const std::uint64_t expected = trace_of(GetParam(), {});
  EXPECT_EQ(trace_of(GetParam(), {.threads = 2}), expected);
  for (const unsigned containers : {2u, 3u, 5u})
    for (const unsigned threads : {1u, 2u})
      EXPECT_EQ(trace_of(GetParam(), {containers, threads}), expected)
          << containers << " containers, " << threads << " threads";
}

INSTANTIATE_TEST_SUITE_P(Distributed, Seeds, ::testing::Range<std::uint64_t>(1, 11));

TEST(Distributed, AnotherSeedGivesAnotherTrace) { EXPECT_NE(trace_of(1, {2}), trace_of(2, {2})); }

TEST(Distributed, AComponentThatFinishesEndsTheRunOfAllContainersAtTheSameTime) {
  std::vector<ContainerSpec> specs = all_of(1, {3});
  for (ContainerSpec& spec : specs)
    spec.components.push_back({.name = "stopper",
                               .type = "test/stopper",
                               .container = "c1",
                               .ports = {{"out", "/stopper", *builtin_profile("state"), PortDirection::output}}});
  for (const MemberResult& result : run_in_threads(specs, RunControl{})) {
    EXPECT_EQ(result.report.end, RunEnd::finished);
    EXPECT_EQ(result.report.reason, "100 ms are enough");
    EXPECT_EQ(result.report.ended_at, Time{} + 100ms);
  }
}

TEST(Distributed, AStopWishOfOneContainerEndsTheRunOfAllAtTheSameTime) {
  std::atomic<bool> stop{false};
  std::vector<RunControl> controls(3);
  controls[2].stop = &stop;
  controls[1].progress = [&](Time now) {
    if (now > Time{}) stop = true;
  };
  const std::vector<MemberResult> results = run_in_threads(all_of(1, {3}), controls);
  for (const MemberResult& result : results) {
    EXPECT_EQ(result.report.end, RunEnd::interrupted);
    EXPECT_EQ(result.report.reason, "interrupted");
    EXPECT_EQ(result.report.ended_at, results[0].report.ended_at);
    EXPECT_EQ(result.trace, results[0].trace);
  }
}

TEST(Distributed, TheShortestTimeLimitIsThatOfAll) {
  std::vector<RunControl> controls(2);
  controls[0].limit = 10s;
  controls[1].limit = 70ms;
  for (const MemberResult& result : run_in_threads(all_of(1, {2}), controls)) {
    EXPECT_EQ(result.report.end, RunEnd::time_limit);
    EXPECT_EQ(result.report.ended_at, Time{} + 70ms);
  }
}

TEST(Distributed, ALoopThatNeverEndsIsNamedInAllContainers) {
  const auto ball = [](const char* name, const char* in, const char* out, const char* container) {
    const QosProfile event = *builtin_profile("event");
    return runtime::ComponentSpec{
        .name = name,
        .type = "test/ball",
        .container = container,
        .ports = {{"in", in, event, PortDirection::input}, {"out", out, event, PortDirection::output}}};
  };
  std::vector<ContainerSpec> specs = all_of(1, {2});
  for (ContainerSpec& spec : specs)
    spec.components = {ball("ping", "/b", "/a", "c1"), ball("pong", "/a", "/b", "c0"), ball("dead", "/c", "/d", "c0")};
  for (const MemberResult& result : run_in_threads(specs, RunControl{})) {
    EXPECT_EQ(result.report.end, RunEnd::livelock);
    EXPECT_EQ(result.report.reason, "components publish to each other for ever at one time: ping, pong");
  }
}

TEST(Distributed, ARunWithoutTimersEndsIdleEverywhere) {
  std::vector<ContainerSpec> specs = all_of(1, {2});
  for (ContainerSpec& spec : specs) spec.components.clear();
  for (const MemberResult& result : run_in_threads(specs, RunControl{}))
    EXPECT_EQ(result.report.end, RunEnd::idle) << result.report.reason;
}

TEST(Distributed, AHandlerThatTakesLongIsNoFailureButIsNamedByThoseWhoWait) {
  const Folder folder;
  std::vector<ContainerSpec> specs = all_of(1, {2});
  for (ContainerSpec& spec : specs) {
    spec.run_folder = folder.path();
    spec.components.push_back({.name = "sleeper",
                               .type = "test/sleeper",
                               .container = "c1",
                               .ports = {{"out", "/sleeper", *builtin_profile("state"), PortDirection::output}}});
  }
  for (const MemberResult& result : run_in_threads(specs, {.limit = 50ms}))
    EXPECT_EQ(result.report.end, RunEnd::time_limit) << result.report.reason;
  EXPECT_THAT(text_of(folder.path() / "log-c0.txt"),
              HasSubstr("t = 0.000000 s, cycle 0: waiting for the fence of container c1"));
}

/// Two containers, of which the second does not come out of its first handler before the test lets it.
class AtTheGate : public ::testing::Test {
 protected:
  AtTheGate() : specs_(all_of(1, {2})) {
    for (ContainerSpec& spec : specs_)
      spec.components.push_back({.name = "gate",
                                 .type = "test/gate",
                                 .container = "c1",
                                 .ports = {{"out", "/gate", *builtin_profile("state"), PortDirection::output}}});
  }

  /// The reports of both; the gate opens when the first one has ended.
  std::vector<runtime::RunReport> run(const RunControl& first, const RunControl& second) {
    ClosedGate gate;
    MemberResult inside;
    std::thread thread([&] { inside = run_member(specs_[1], second); });
    const MemberResult outside = run_member(specs_[0], first);
    gate.open();
    thread.join();
    return {outside.report, inside.report};
  }

  std::vector<ContainerSpec> specs_;
};

TEST_F(AtTheGate, AContainerThatIsToldToStopWaitsForNobodyAndTheOthersAreToldWhy) {
  std::atomic<bool> stop{false};
  RunControl told;
  told.stop = &stop;
  told.phase = [&](runtime::RunPhase phase) { stop = phase == runtime::RunPhase::active; };
  const auto reports = run(told, RunControl{});
  EXPECT_EQ(reports[0].end, RunEnd::interrupted);
  EXPECT_EQ(reports[0].reason, "interrupted");
  EXPECT_EQ(reports[1].end, RunEnd::interrupted);
  EXPECT_EQ(reports[1].reason, "container 'c0' was told to stop while it waited for the fence of container c1");
  for (const runtime::RunReport& report : reports) EXPECT_TRUE(report.broken_off);
}

TEST_F(AtTheGate, AContainerThatIsInOneHandlerForTooLongIsLost) {
  const auto reports = run(RunControl{}, {.longest_handler = 100ms});
  EXPECT_EQ(reports[0].end, RunEnd::peer_lost);
  EXPECT_EQ(reports[0].reason, "container 'c1' died or stopped; the run was at t = 0.000000 s, cycle 0");
  EXPECT_EQ(reports[1].end, RunEnd::peer_lost);
  EXPECT_EQ(reports[1].reason, "the others gave this container up: " + reports[0].reason);
}

TEST(Distributed, AMemberThatNeverComesIsNamed) {
  const MemberResult result = run_member(all_of(1, {3})[0], {.members_within = 300ms});
  EXPECT_EQ(result.report.end, RunEnd::peer_lost);
  EXPECT_EQ(result.report.reason, "waited in vain for container c1, c2 within 1 s");
}

TEST(Distributed, AMemberThatRunsAnotherCompositionIsNamed) {
  std::vector<ContainerSpec> specs = all_of(1, {2});
  specs[1].components.push_back({.name = "more", .type = "test/ball", .container = "c0"});
  const std::vector<MemberResult> results = run_in_threads(specs, RunControl{});
  for (unsigned i = 0; i < 2; ++i) {
    EXPECT_EQ(results[i].report.end, RunEnd::peer_lost);
    EXPECT_EQ(results[i].report.reason,
              "container c" + std::to_string(1 - i) + " runs another composition, or places it differently");
  }
}

/// Plays the container c1 of two to the container c0: says the same of itself in every fence as the other one does. Its
/// only component writes /numbers.
class Mirror final : public dds::SampleSink {
 public:
  explicit Mirror(const std::string& tag)
      : domain_({.id = 41, .tag = tag, .external_id = 40}),
        numbers_(domain_, "/numbers", type_support<sensor_msgs::msg::Range>(), *builtin_profile("event"),
                 dds::CyclonePart::carrier, 0, 0),
        fences_(domain_, "/kervan/fence", type_support<Fence>(), kProfile, dds::CyclonePart::whole_profile, 0, 1),
        reader_(domain_, "/kervan/fence", type_support<Fence>(), kProfile, dds::CyclonePart::whole_profile, *this, 1) {}

  /// Answers what has come; in the answer to the fence of t = 0, cycle 0, promises so many numbers.
  void answer(std::uint64_t promised) {
    fences_.assert_alive();
    std::unique_lock lock(mutex_);
    for (; !heard_.empty(); heard_.pop_front()) {
      dds::SampleBlock* const block = fences_.loan(true);
      auto& fence = *static_cast<Fence*>(dds::mutable_value_of(block));
      fence = *heard_.front();
      fence.container = 1;
      fence.traces.clear();
      if (fence.t == 0 && fence.d == 0) {
        fence.more = true;
        fence.sent.emplace_back().sent = promised;
      }
      fences_.publish(block, Time{}, false);
      answered_ = std::max(answered_, fence.t);
    }
  }
  bool has_promised() const { return answered_ == 0; }
  void publish_number() { numbers_.publish(numbers_.loan(true), Time{}, false); }

  void on_sample(const dds::Arrival& arrival) noexcept override {
    if (static_cast<const Fence*>(dds::value_of(arrival.block))->container != 0) return;
    const std::lock_guard lock(mutex_);
    heard_.emplace_back(arrival.block);
  }
  void on_writer_gone(std::uint64_t) noexcept override {}
  void on_status() noexcept override {}

 private:
  using Fence = kervan_msgs::msg::Fence;
  /// As of every container.
  inline static const QosProfile kProfile{
      .name = "fence", .depth = 0, .liveliness = Liveliness::manual, .lease = 1500ms, .trace = false};

  std::mutex mutex_;
  std::deque<Sample<Fence>> heard_;
  std::int64_t answered_ = -1;
  dds::Domain domain_;
  dds::Writer numbers_, fences_;
  dds::Reader reader_;  // last: it calls into the members above
};

TEST(Distributed, SamplesThatAreAnnouncedAndDoNotComeAreNamed) {
  const Folder folder;
  const QosProfile event = *builtin_profile("event");
  const std::string tag = new_tag();
  ContainerSpec spec = stations(1, {2}, 0, tag);
  spec.run_folder = folder.path();
  const auto ball = [&](const char* name, const char* container, const char* in, const char* out) {
    return runtime::ComponentSpec{
        .name = name,
        .type = "test/ball",
        .container = container,
        .ports = {{"in", in, event, PortDirection::input}, {"out", out, event, PortDirection::output}}};
  };
  spec.components = {ball("speaker", "c1", "/nothing", "/numbers"), ball("hearer", "c0", "/numbers", "/echo")};
  MemberResult result;
  std::atomic<bool> ended{false};
  Mirror mirror(tag);
  std::thread thread([&] {
    result = run_member(spec, {.limit = 50ms});
    ended = true;
  });
  int published = 0;
  EXPECT_TRUE(eventually([&] {
    mirror.answer(3);
    if (!mirror.has_promised()) return ended.load();
    if (published == 0) mirror.publish_number(), ++published;
    if (published == 1 && text_of(folder.path() / "log-c0.txt").find(" samples of ") != std::string::npos)
      for (; published < 3; ++published) mirror.publish_number();
    return ended.load();
  }));
  thread.join();
  EXPECT_EQ(result.report.end, RunEnd::time_limit) << result.report.reason;
  EXPECT_THAT(text_of(folder.path() / "log-c0.txt"),
              HasSubstr("t = 0.000000 s, cycle 0: waiting for hearer.in, which has 1 of 3 samples of speaker.out in "
                        "container c1\n"));
}

std::string refusal_of(const ContainerSpec& spec) {
  ComponentRegistry registry = station_registry();
  try {
    const runtime::Container container(spec, registry);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(Distributed, ARunWithoutATagOfItsOwnIsRefused) {
  EXPECT_EQ(refusal_of(stations(1, {2}, 0, "")),
            "container 'c0' of a lockstep run in 2 containers needs a tag of its own for each run, or two runs hear "
            "each other: domain.tag is empty");
  ContainerSpec spec = stations(1, {2}, 0, new_tag());
  spec.domain.network = false;
  EXPECT_EQ(refusal_of(spec),
            "container 'c0' of a lockstep run in 2 containers needs a network: domain.network is false");
  spec = stations(1, {2}, 0, new_tag());
  spec.members = {"c1", "c2"};
  EXPECT_THAT(refusal_of(spec),
              HasSubstr("container 'c0' of a lockstep run in 2 containers is not one of its members"));
}

TEST(Distributed, AnInputOfTheFrameworksOwnTopicsIsRefused) {
  ContainerSpec spec = stations(1, {2}, 0, new_tag());
  spec.components[0].ports[0].topic = "/kervan/anything";
  EXPECT_EQ(
      refusal_of(spec),
      "station0.in hears /kervan/anything, which every container publishes in its own time; under lockstep only a "
      "composition in one container can do that");
}

// In processes. A member says "began" when all are there and it is active, and at the end why, and the trace.

struct Processes {
  std::vector<std::unique_ptr<Peer>> members;

  Processes(std::uint64_t seed, unsigned containers, Duration limit) {
    const std::string tag = new_tag();
    for (unsigned i = 0; i < containers; ++i)
      members.push_back(std::make_unique<Peer>(std::vector<std::string>{
          "--member", std::to_string(seed), std::to_string(containers), std::to_string(i), tag,
          std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(limit).count())}));
  }

  bool all_have_begun() {
    return eventually(
        [&] { return std::ranges::all_of(members, [](const auto& member) { return member->has_said("began"); }); });
  }

  /// What a member says at its end: "end: …".
  std::string end_of(unsigned member) {
    std::string end;
    eventually([&] {
      for (const std::string& line : members[member]->lines())
        if (line.starts_with("end: ")) end = line;
      return !end.empty();
    });
    return end;
  }
};

int be_member(const std::vector<std::string>& arguments) {
  const Placement placement{.containers = static_cast<unsigned>(std::stoul(arguments.at(1)))};
  const unsigned self = static_cast<unsigned>(std::stoul(arguments.at(2)));
  const ContainerSpec spec = stations(std::stoull(arguments.at(0)), placement, self, arguments.at(3));
  RunControl control;
  if (const long limit = std::stol(arguments.at(4)); limit > 0) control.limit = std::chrono::milliseconds(limit);
  control.phase = [](runtime::RunPhase phase) {
    if (phase != runtime::RunPhase::active) return;
    std::puts("began");
    std::fflush(stdout);
  };
  const MemberResult result = run_member(spec, control);
  std::printf("end: %s: %s\n", std::string(to_text(result.report.end)).c_str(), result.report.reason.c_str());
  std::printf("trace: %016" PRIx64 "\n", result.trace);
  return 0;
}

TEST(Processes, GiveTheSameTraceAsOneContainer) {
  for (const std::uint64_t seed : {1u, 2u}) {
    char expected[32];
    std::snprintf(expected, sizeof expected, "trace: %016" PRIx64, trace_of(seed, {}, 1s));
    for (const unsigned containers : {2u, 3u, 5u}) {
      Processes processes(seed, containers, 1s);
      for (const auto& member : processes.members) {
        EXPECT_EQ(member->end(), 0);
        EXPECT_TRUE(member->has_said(expected)) << ::testing::PrintToString(member->lines());
      }
    }
  }
}

TEST(Processes, AMemberThatIsKilledEndsTheRunOfAllOthersWhoNameIt) {
  Processes processes(1, 3, 0ms);
  ASSERT_TRUE(processes.all_have_begun());
  processes.members[1]->signal(SIGKILL);
  for (const unsigned member : {0u, 2u})
    EXPECT_THAT(processes.end_of(member),
                MatchesRegex("end: peer lost: container 'c1' died or stopped; the run was at t = [0-9.]+ s, cycle "
                             "[0-9]+"));
}

TEST(Processes, AMemberThatIsStoppedEndsTheRunOfAllOthersWhoNameItAndItsOwnWhenItGoesOn) {
  Processes processes(1, 3, 0ms);
  ASSERT_TRUE(processes.all_have_begun());
  processes.members[2]->signal(SIGSTOP);
  for (const unsigned member : {0u, 1u})
    EXPECT_THAT(processes.end_of(member), HasSubstr("peer lost: container 'c2' died or stopped"));
  processes.members[2]->signal(SIGCONT);
  EXPECT_THAT(processes.end_of(2), HasSubstr("peer lost"));
}

class Watchdog final : public ::testing::EmptyTestEventListener {
  void OnTestStart(const ::testing::TestInfo&) override { alarm(kWatchdogSeconds); }
};

}  // namespace
}  // namespace kervan::test

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "--member") {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    alarm(kervan::test::kWatchdogSeconds);
    return kervan::test::be_member({argv + 2, argv + argc});
  }
  ::testing::InitGoogleTest(&argc, argv);
  ::testing::UnitTest::GetInstance()->listeners().Append(new kervan::test::Watchdog);
  return RUN_ALL_TESTS();
}
