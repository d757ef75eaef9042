// Quality of service between processes, as far as Cyclone DDS has to see to it: two domains of one process that meet on
// the network as two processes do.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <mutex>

#include "framework/component/sample.hpp"
#include "framework/dds/endpoint.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"
#include "tests/conformance/wire/peer.hpp"

namespace {

using namespace kervan;
using namespace std::chrono_literals;
using dds::CyclonePart;
using kervan_msgs::msg::MotionRequest;
using test::eventually;
using Lines = std::vector<std::string>;

/// On a logical clock.
constexpr Time kPublished = Time(1234567891ns);

class Collector final : public dds::SampleSink {
 public:
  Lines lines() const {
    const std::lock_guard lock(mutex_);
    return lines_;
  }
  void on_sample(const dds::Arrival& arrival) noexcept override {
    const auto& request = *static_cast<const MotionRequest*>(dds::value_of(arrival.block));
    say((dds::is_assertion(arrival.block)  ? "alive "
         : dds::is_disposed(arrival.block) ? "disposed "
                                           : "sample ") +
        std::to_string(request.priority) + " of strength " + std::to_string(arrival.strength) +
        (dds::published_at(arrival.block) == kPublished ? "" : " at another time"));
  }
  void on_writer_gone(std::uint64_t) noexcept override { say("gone"); }
  void on_writer_lost(std::uint64_t) noexcept override { say("lost"); }
  void on_status() noexcept override {}

 private:
  void say(const std::string& line) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(line);
  }
  mutable std::mutex mutex_;
  Lines lines_;
};

class BetweenProcesses : public testing::Test {
 protected:
  static dds::DomainConfig config(std::uint32_t id) {
    static const std::string tag = "qos_wire_test-" + std::to_string(getpid());
    return {.id = id, .tag = tag, .external_id = 20 + static_cast<std::uint32_t>(getpid()) % 200};
  }
  dds::Domain here_{config(216)};
  dds::Domain there_{config(217)};
  const TypeSupport& type_ = type_support<MotionRequest>();

  static dds::SampleBlock* filled(dds::Writer& writer, int number) {
    dds::SampleBlock* block = writer.loan(true);
    static_cast<MotionRequest*>(dds::mutable_value_of(block))->priority = number;
    return block;
  }
  static void publish(dds::Writer& writer, int number, bool dispose = false) {
    writer.publish(filled(writer, number), kPublished, dispose);
  }
  static QosProfile event() { return *builtin_profile("event"); }
};

TEST_F(BetweenProcesses, AnAssertionArrivesAsOneAndKeepsItsPlace) {
  dds::Writer writer(here_, "/alive", type_, event(), CyclonePart::carrier, 7, 0);
  Collector collector;
  const dds::Reader reader(there_, "/alive", type_, event(), CyclonePart::carrier, collector);
  ASSERT_TRUE(eventually([&] { return writer.status().matched == 1 && reader.status().matched == 1; }));
  publish(writer, 1);
  writer.publish_assertion(filled(writer, 1), kPublished);
  publish(writer, 2);
  publish(writer, 2, true);
  EXPECT_TRUE(eventually([&] { return collector.lines().size() == 4; }));
  EXPECT_EQ(collector.lines(), (Lines{"sample 1 of strength 7", "alive 1 of strength 7", "sample 2 of strength 7",
                                      "disposed 2 of strength 7"}));
}

TEST_F(BetweenProcesses, AWriterThatIsSilentForALeaseIsLostAndComesBack) {
  QosProfile profile = event();
  profile.liveliness = Liveliness::manual;
  profile.lease = 100ms;
  dds::Writer writer(here_, "/alive", type_, profile, CyclonePart::whole_profile, 0, 0);
  Collector near, far;
  const dds::Reader in_its_process(here_, "/alive", type_, profile, CyclonePart::whole_profile, near);
  const dds::Reader elsewhere(there_, "/alive", type_, profile, CyclonePart::whole_profile, far);
  ASSERT_TRUE(eventually([&] { return writer.status().matched == 2 && elsewhere.status().matched == 1; }));
  for (int n = 1; n <= 2; ++n) {
    publish(writer, n);
    const auto lost = static_cast<std::ptrdiff_t>(n);
    for (const Collector* collector : {&near, &far})
      EXPECT_TRUE(eventually([&] { return std::ranges::count(collector->lines(), "lost") >= lost; }));
  }
}

TEST_F(BetweenProcesses, PartitionsKeepApartWhomTheyKeepApartWithinOne) {
  QosProfile left = event(), right = event(), pattern = event();
  left.partition = {"left"};
  right.partition = {"right"};
  pattern.partition = {"*t"};
  dds::Writer writer(here_, "/parted", type_, left, CyclonePart::whole_profile, 0, 0);
  Collector same, other, fits, without;
  const dds::Reader r1(there_, "/parted", type_, left, CyclonePart::whole_profile, same);
  const dds::Reader r2(there_, "/parted", type_, right, CyclonePart::whole_profile, other);
  const dds::Reader r3(there_, "/parted", type_, pattern, CyclonePart::whole_profile, fits);
  const dds::Reader r4(there_, "/parted", type_, event(), CyclonePart::whole_profile, without);
  ASSERT_TRUE(
      eventually([&] { return writer.status().matched == 2 && r1.status().matched == 1 && r3.status().matched == 1; }));
  publish(writer, 1);
  EXPECT_TRUE(eventually([&] { return !same.lines().empty() && !fits.lines().empty(); }));
  EXPECT_TRUE(other.lines().empty());
  EXPECT_TRUE(without.lines().empty());
}

/// Why a composition may not ask for it.
TEST_F(BetweenProcesses, ABestEffortReaderGetsNoOldSamples) {
  QosProfile profile = *builtin_profile("latched");
  dds::Writer writer(here_, "/latched", type_, profile, CyclonePart::whole_profile, 0, 0);
  publish(writer, 1);
  profile.reliability = Reliability::best_effort;
  Collector near, far;
  const dds::Reader in_its_process(here_, "/latched", type_, profile, CyclonePart::whole_profile, near);
  const dds::Reader elsewhere(there_, "/latched", type_, profile, CyclonePart::whole_profile, far);
  ASSERT_TRUE(eventually([&] { return writer.status().matched == 2 && elsewhere.status().matched == 1; }));
  EXPECT_TRUE(eventually([&] {
    publish(writer, 2);
    return !near.lines().empty() && !far.lines().empty();
  }));
  EXPECT_EQ(near.lines().front(), "sample 2 of strength 0");
  EXPECT_EQ(far.lines().front(), "sample 2 of strength 0");
}

}  // namespace
