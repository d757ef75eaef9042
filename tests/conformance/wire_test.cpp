/// Between processes, over the loopback interface: Kervan's data path against a plain Cyclone C program under ROS 2's
/// wire names, and against itself. Each test has a domain tag of its own, so no other run is heard.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <stdexcept>

#include "framework/component/sample.hpp"
#include "framework/dds/endpoint.hpp"
#include "framework/dds/sample_block.hpp"
#include "framework/dds/statistics.hpp"
#include "framework/dds/wall_clock.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "tests/conformance/wire/c_peer.h"
#include "tests/conformance/wire/peer.hpp"

namespace kervan::test {
namespace {

using kervan_msgs::msg::MotionRequest;
using sensor_msgs::msg::LaserScan;
using Lines = std::vector<std::string>;

/// Longer than a test that waits with all its patience twice, shorter than ctest's limit, so that this one speaks.
constexpr unsigned kWatchdogSeconds = 110;

/// Sample number n; c_peer.c has the same for idlc's type. Every fifth needs many datagrams.
LaserScan scan_number(int n) {
  const auto x = static_cast<float>(n);
  LaserScan scan;
  scan.header.stamp.sec = n;
  scan.header.stamp.nanosec = 1000U * static_cast<unsigned>(n);
  scan.header.frame_id = "r1/laser";
  scan.angle_min = -0.5F * x;
  scan.angle_max = 0.5F * x;
  scan.angle_increment = 0.25F;
  scan.time_increment = 0.125F;
  scan.scan_time = x / 16.0F;
  scan.range_min = 0.05F;
  scan.range_max = x + 0.5F;
  scan.ranges.resize(n % 5 == 0 ? 100000U : static_cast<unsigned>(n % 5));
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) scan.ranges[i] = x + 0.5F * static_cast<float>(i);
  for (int i = 0; i < n % 3; ++i) scan.intensities.push_back(-static_cast<float>(i));
  return scan;
}

QosProfile reliable() { return *builtin_profile("event"); }
QosProfile best_effort() { return *builtin_profile("sensor"); }
QosProfile latched() { return *builtin_profile("latched"); }

using TextOf = std::string (*)(const dds::Arrival&);

std::string text_of_scan(const dds::Arrival& arrival) {
  const auto& scan = *static_cast<const LaserScan*>(dds::value_of(arrival.block));
  return "sample " + std::to_string(scan.header.stamp.sec) +
         (scan == scan_number(scan.header.stamp.sec) ? " right" : " wrong");
}

std::string text_of_request(const dds::Arrival& arrival) {
  const auto& request = *static_cast<const MotionRequest*>(dds::value_of(arrival.block));
  if (dds::is_disposed(arrival.block)) return "dispose " + request.behaviour;
  return "sample " + request.behaviour + " " + std::to_string(request.priority);
}

/// Keeps what arrives, as lines that say what it was; prints them too with `aloud`.
class Collector final : public dds::SampleSink {
 public:
  explicit Collector(TextOf text_of, bool aloud = false) : text_of_(text_of), aloud_(aloud) {}

  Lines lines() const {
    const std::lock_guard lock(mutex_);
    return lines_;
  }
  bool has(const std::string& line) const {
    const Lines all = lines();
    return std::find(all.begin(), all.end(), line) != all.end();
  }

  void say(const std::string& line) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(line);
    if (!aloud_) return;
    std::puts(line.c_str());
    std::fflush(stdout);
  }

  void on_sample(const dds::Arrival& arrival) noexcept override { say(text_of_(arrival)); }
  void on_writer_gone(std::uint64_t) noexcept override { say("gone"); }
  void on_status() noexcept override {}

 private:
  const TextOf text_of_;
  const bool aloud_;
  mutable std::mutex mutex_;
  Lines lines_;
};

struct Network {
  std::uint32_t domain;
  std::string tag;

  /// One that no other test of this machine uses at this time.
  static Network of_its_own() {
    static int tests = 0;
    const auto pid = static_cast<unsigned>(getpid());
    return {20 + pid % 200, "wire_test-" + std::to_string(pid) + "-" + std::to_string(++tests)};
  }
  dds::DomainConfig config() const { return {.id = domain, .tag = tag}; }

  std::vector<std::string> peer(const std::string& role, const QosProfile& profile, int count = 0,
                                bool type_information = false) const {
    return {"--peer",
            role,
            std::to_string(domain),
            tag,
            profile.name,
            std::to_string(count),
            type_information ? "typed" : "untyped"};
  }
};

template <class T>
void publish(dds::Writer& writer, const T& value, bool dispose = false) {
  dds::SampleBlock* block = writer.loan(false);
  *static_cast<T*>(dds::mutable_value_of(block)) = value;
  writer.publish(block, dds::wall_now(), dispose);
}

Lines right_samples(int first, int last) {
  Lines lines;
  for (int n = first; n <= last; ++n) lines.push_back("sample " + std::to_string(n) + " right");
  return lines;
}

Lines samples_of(Lines lines) {
  std::erase_if(lines, [](const std::string& line) { return !line.starts_with("sample"); });
  return lines;
}

// --------------------------------------------------------------------------------- Kervan and a plain C program

/// Whether the C program publishes XTypes information, as idlc's programs do and ROS 2's do not.
class WithAPlainProgram : public ::testing::TestWithParam<bool> {
 protected:
  Network network_ = Network::of_its_own();
  dds::Domain domain_{network_.config()};
};

INSTANTIATE_TEST_SUITE_P(Wire, WithAPlainProgram, ::testing::Bool(),
                         [](const auto& test) { return test.param ? "WithTypeInformation" : "AsRos2"; });

TEST_P(WithAPlainProgram, ReliableSamplesOfKervanArriveAllAndUnchanged) {
  dds::Writer writer(domain_, "/scan", type_support<LaserScan>(), reliable(), dds::CyclonePart::whole_profile, 0, 0);
  Peer peer(network_.peer("c-read", reliable(), 0, GetParam()));
  ASSERT_TRUE(eventually([&] { return peer.has_said("ready") && writer.status().matched == 1; }));
  for (int n = 1; n <= 20; ++n) publish(writer, scan_number(n));
  ASSERT_TRUE(eventually([&] { return peer.lines_that_begin_with("sample") >= 20; }));
  EXPECT_EQ(samples_of(peer.lines()), right_samples(1, 20));
  EXPECT_EQ(peer.end(), 0);
}

TEST_P(WithAPlainProgram, BestEffortSamplesOfKervanArriveUnchanged) {
  dds::Writer writer(domain_, "/scan", type_support<LaserScan>(), best_effort(), dds::CyclonePart::whole_profile, 0, 0);
  Peer peer(network_.peer("c-read", best_effort(), 0, GetParam()));
  ASSERT_TRUE(eventually([&] { return peer.has_said("ready") && writer.status().matched == 1; }));
  int n = 0;
  EXPECT_TRUE(eventually([&] {
    publish(writer, scan_number(n = n % 4 + 1));
    return peer.has_said("sample 1 right") && peer.has_said("sample 4 right");
  }));
  for (const std::string& line : samples_of(peer.lines())) EXPECT_TRUE(line.ends_with("right")) << line;
  EXPECT_EQ(peer.end(), 0);
}

TEST_P(WithAPlainProgram, ReliableSamplesOfAProgramArriveAllAndUnchanged) {
  Collector collector(text_of_scan);
  const dds::Reader reader(domain_, "/scan", type_support<LaserScan>(), reliable(), dds::CyclonePart::whole_profile,
                           collector);
  Peer peer(network_.peer("c-write", reliable(), 20, GetParam()));
  ASSERT_TRUE(eventually([&] { return collector.lines().size() >= 20; }));
  EXPECT_EQ(peer.end(), 0);
  ASSERT_TRUE(eventually([&] { return collector.has("gone"); }));
  Lines expected = right_samples(1, 20);
  expected.push_back("gone");
  EXPECT_EQ(collector.lines(), expected);
}

TEST_P(WithAPlainProgram, BestEffortSamplesOfAProgramArriveUnchanged) {
  Collector collector(text_of_scan);
  const dds::Reader reader(domain_, "/scan", type_support<LaserScan>(), best_effort(), dds::CyclonePart::whole_profile,
                           collector);
  Peer peer(network_.peer("c-write", best_effort(), 4, GetParam()));
  EXPECT_TRUE(eventually([&] { return collector.has("sample 1 right") && collector.has("sample 4 right"); }))
      << reader.status().incompatible << " refused, policy " << reader.status().last_incompatible_id;
  EXPECT_EQ(peer.end(), 0);
  for (const std::string& line : samples_of(collector.lines())) EXPECT_TRUE(line.ends_with("right")) << line;
}

TEST_P(WithAPlainProgram, ALateJoinerGetsTheLatestSampleOfKervan) {
  dds::Writer writer(domain_, "/scan", type_support<LaserScan>(), latched(), dds::CyclonePart::whole_profile, 0, 0);
  for (int n = 1; n <= 3; ++n) publish(writer, scan_number(n));
  Peer peer(network_.peer("c-read", latched(), 0, GetParam()));
  ASSERT_TRUE(eventually([&] { return peer.has_said("sample 3 right"); }));
  publish(writer, scan_number(4));
  ASSERT_TRUE(eventually([&] { return peer.has_said("sample 4 right"); }));
  EXPECT_EQ(samples_of(peer.lines()), right_samples(3, 4));
  EXPECT_EQ(peer.end(), 0);
}

// --------------------------------------------------------------------------------- Kervan and Kervan

TEST(Wire, KeyedInstancesComeAndGoInAnotherProcess) {
  const Network network = Network::of_its_own();
  dds::Domain domain(network.config());
  Peer peer(network.peer("kervan-read-requests", reliable()));
  {
    dds::Writer writer(domain, "/requests", type_support<MotionRequest>(), reliable(), dds::CyclonePart::whole_profile,
                       0, 0);
    ASSERT_TRUE(eventually([&] { return peer.has_said("ready") && writer.status().matched == 1; }));
    // The second name is longer than a key hash, so its hash is a digest.
    const auto request = [](const std::string& behaviour, int priority) {
      MotionRequest value;
      value.behaviour = behaviour;
      value.priority = priority;
      return value;
    };
    publish(writer, request("stall", 1));
    publish(writer, request("keep away from everything that moves", 2));
    publish(writer, request("stall", 3));
    publish(writer, request("stall", 0), true);
    publish(writer, request("keep away from everything that moves", 4));
    publish(writer, request("stall", 5));
    ASSERT_TRUE(eventually([&] { return peer.has_said("sample stall 5"); }));
  }
  EXPECT_TRUE(eventually([&] { return peer.has_said("gone"); }));
  EXPECT_EQ(peer.lines(),
            (Lines{"ready", "sample stall 1", "sample keep away from everything that moves 2", "sample stall 3",
                   "dispose stall", "sample keep away from everything that moves 4", "sample stall 5", "gone"}));
  EXPECT_EQ(peer.end(), 0);
}

TEST(Wire, ALateJoinerInAnotherProcessGetsTheLatestSample) {
  const Network network = Network::of_its_own();
  dds::Domain domain(network.config());
  dds::Writer writer(domain, "/scan", type_support<LaserScan>(), latched(), dds::CyclonePart::whole_profile, 0, 0);
  for (int n = 1; n <= 5; ++n) publish(writer, scan_number(n));
  Peer peer(network.peer("kervan-read-scans", latched()));
  ASSERT_TRUE(eventually([&] { return peer.has_said("sample 5 right"); }));
  publish(writer, scan_number(6));
  ASSERT_TRUE(eventually([&] { return peer.has_said("sample 6 right"); }));
  EXPECT_EQ(samples_of(peer.lines()), right_samples(5, 6));
  EXPECT_EQ(peer.end(), 0);
}

TEST(Wire, ASampleIsSerialisedOnceForTwoRemoteReadersAndNotAtAllForTheLocalOne) {
  const Network network = Network::of_its_own();
  dds::Domain domain(network.config());
  Collector collector(text_of_scan);
  const dds::Reader local(domain, "/scan", type_support<LaserScan>(), reliable(), dds::CyclonePart::whole_profile,
                          collector);
  dds::Writer writer(domain, "/scan", type_support<LaserScan>(), reliable(), dds::CyclonePart::whole_profile, 0, 0);
  const dds::DataPathStatistics before = dds::data_path_statistics();
  for (int n = 1; n <= 10; ++n) publish(writer, scan_number(n));
  EXPECT_EQ(collector.lines(), right_samples(1, 10));
  EXPECT_EQ(dds::data_path_statistics().serialised, before.serialised);

  Peer first(network.peer("kervan-read-scans", reliable()));
  Peer second(network.peer("c-read", reliable()));
  ASSERT_TRUE(
      eventually([&] { return first.has_said("ready") && second.has_said("ready") && writer.status().matched == 3; }));
  for (int n = 11; n <= 20; ++n) publish(writer, scan_number(n));
  ASSERT_TRUE(eventually([&] { return first.has_said("sample 20 right") && second.has_said("sample 20 right"); }));
  EXPECT_EQ(samples_of(first.lines()), right_samples(11, 20));
  EXPECT_EQ(samples_of(second.lines()), right_samples(11, 20));
  const dds::DataPathStatistics after = dds::data_path_statistics();
  EXPECT_EQ(after.serialised, before.serialised + 10);
  EXPECT_EQ(after.deserialised, before.deserialised);
  EXPECT_EQ(first.end(), 0);
  EXPECT_EQ(second.end(), 0);
}

TEST(Wire, EveryPartOfALargeSampleIsTheSameWhetherItWasCopiedOrIsSentOutOfTheValue) {
  const Network network = Network::of_its_own();
  dds::Domain domain(network.config());
  dds::Writer writer(domain, "/scan", type_support<LaserScan>(), reliable(), dds::CyclonePart::whole_profile, 0, 0);
  dds::SampleBlock* block = writer.loan(true);
  auto& scan = *static_cast<LaserScan*>(dds::mutable_value_of(block));
  scan = scan_number(5);
  const TypeSupport& support = type_support<LaserScan>();
  std::vector<std::byte> expected(cdr::encapsulation_size + support.cdr_size(&scan));
  cdr::Writer plain(expected.data() + cdr::encapsulation_size, expected.size() - cdr::encapsulation_size);
  support.write_cdr(&scan, plain);
  const auto header = cdr::encapsulation(expected.size() - cdr::encapsulation_size);
  std::copy(header.begin(), header.end(), expected.begin());
  ASSERT_EQ(expected.size() % 4, 0U);

  for (const std::size_t length : {std::size_t{4}, std::size_t{1344}, std::size_t{64000}, expected.size()}) {
    for (std::size_t offset = 0; offset < expected.size(); offset += length) {
      const std::size_t size = std::min(length, expected.size() - offset);
      std::vector<std::byte> copy(size);
      ddsi_serdata_to_ser(block, offset, size, copy.data());
      ASSERT_TRUE(std::equal(copy.begin(), copy.end(), expected.begin() + static_cast<std::ptrdiff_t>(offset)));
      ddsrt_iovec_t part;
      ddsi_serdata* serdata = ddsi_serdata_to_ser_ref(block, offset, size, &part);
      ASSERT_EQ(part.iov_len, size);
      ASSERT_EQ(std::memcmp(part.iov_base, expected.data() + offset, size), 0) << offset << " " << size;
      ddsi_serdata_to_ser_unref(serdata, &part);
    }
  }
  dds::release(block);
}

// --------------------------------------------------------------------------------- what nobody should send

TEST(Wire, AnotherLayoutUnderTheSameNameIsRefusedCountedAndDoesNoHarm) {
  const Network network = Network::of_its_own();
  dds::Domain domain(network.config());
  Collector collector(text_of_scan);
  const dds::Reader reader(domain, "/scan", type_support<LaserScan>(), reliable(), dds::CyclonePart::whole_profile,
                           collector);
  const dds::DataPathStatistics before = dds::data_path_statistics();
  Peer liar(network.peer("c-write-short", reliable(), 5));
  // The writer is not held up either: what is refused counts as received.
  ASSERT_TRUE(eventually([&] { return liar.has_said("acknowledged"); }));
  EXPECT_TRUE(eventually([&] { return dds::data_path_statistics().refused == before.refused + 5; }));
  EXPECT_EQ(collector.lines(), Lines{});

  Peer honest(network.peer("c-write", reliable(), 5));
  ASSERT_TRUE(eventually([&] { return collector.lines().size() >= 5; }));
  EXPECT_EQ(collector.lines(), right_samples(1, 5));
  EXPECT_EQ(dds::data_path_statistics().refused, before.refused + 5);
  EXPECT_EQ(liar.end(), 0);
  EXPECT_EQ(honest.end(), 0);
}

// --------------------------------------------------------------------------------- the other processes

int kervan_read(const Network& network, const std::string& topic, const TypeSupport& type, const QosProfile& profile,
                TextOf text_of) {
  dds::Domain domain(network.config());
  Collector collector(text_of, true);
  const dds::Reader reader(domain, topic, type, profile, dds::CyclonePart::whole_profile, collector);
  while (reader.status().matched == 0)
    if (!c_peer_wanted()) return 0;
  collector.say("ready");
  while (c_peer_wanted()) {
  }
  return 0;
}

int run_peer(const std::vector<std::string>& arguments) {
  const std::string& role = arguments.at(0);
  const Network network{static_cast<std::uint32_t>(std::stoul(arguments.at(1))), arguments.at(2)};
  const QosProfile profile = builtin_profile(arguments.at(3)).value();
  const c_peer_options_t options{.domain = network.domain,
                                 .tag = network.tag.c_str(),
                                 .reliable = profile.reliability == Reliability::reliable,
                                 .transient_local = profile.durability == Durability::transient_local,
                                 .type_information = arguments.at(5) == "typed",
                                 .count = std::stoi(arguments.at(4))};
  if (role == "c-read") return c_peer_read(&options);
  if (role == "c-write") return c_peer_write(&options);
  if (role == "c-write-short") return c_peer_write_short(&options);
  if (role == "c-write-other") return c_peer_write_other(&options);
  if (role == "kervan-read-scans")
    return kervan_read(network, "/scan", type_support<LaserScan>(), profile, text_of_scan);
  if (role == "kervan-read-requests")
    return kervan_read(network, "/requests", type_support<MotionRequest>(), profile, text_of_request);
  throw std::invalid_argument("no such role: " + role);
}

class Watchdog final : public ::testing::EmptyTestEventListener {
  void OnTestStart(const ::testing::TestInfo&) override { alarm(kWatchdogSeconds); }
};

}  // namespace
}  // namespace kervan::test

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "--peer") {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    alarm(kervan::test::kWatchdogSeconds);
    return kervan::test::run_peer({argv + 2, argv + argc});
  }
  ::testing::InitGoogleTest(&argc, argv);
  ::testing::UnitTest::GetInstance()->listeners().Append(new kervan::test::Watchdog);
  return RUN_ALL_TESTS();
}
