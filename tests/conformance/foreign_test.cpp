/// What is wrong with peers that are not Kervan's is named: their quality of service, their type, their bytes; and what
/// Cyclone logs, and samples that never came.
#include <dds/dds.h>
#include <dds/ddsrt/log.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "framework/dds/wall_clock.hpp"
#include "framework/kervan.hpp"
#include "framework/test/harness.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "tests/conformance/wire/peer.hpp"
#include "tests/runtime/containers.hpp"

namespace {

using namespace std::chrono_literals;
using kervan::PortDirection;
using kervan::runtime::RunPhase;
using kervan::test::binding;
using kervan::test::Composition;
using kervan::test::eventually;
using kervan::test::Peer;
using kervan::test::Running;
using sensor_msgs::msg::LaserScan;
using ::testing::HasSubstr;

class Scanner final : public kervan::Component {
  kervan::Output<LaserScan> out_{this, "out", kervan::qos::sensor, "Scans."};
  kervan::Timer tick_{this, 10ms, &Scanner::on_tick};
  void on_tick(kervan::Time) { out_.publish(LaserScan{}); }
};

class Mapper final : public kervan::Component {
  kervan::Input<LaserScan> in_{this, "in", kervan::qos::event, &Mapper::on_scan, "Scans."};
  void on_scan(const LaserScan&, kervan::Time) {}
};

const auto scanner = kervan::test::define<Scanner>("test/scanner");
const auto mapper = kervan::test::define<Mapper>("test/mapper");

/// A container with one component on /scan, and what a peer needs to meet it.
class Foreign : public ::testing::Test {
 protected:
  Composition composition_{{"main"}};

  std::vector<std::string> peer(const std::string& role, const std::string& profile, int count = 0) {
    const kervan::dds::DomainConfig config = composition_.spec("main").domain;
    return {"--peer", role, std::to_string(*config.external_id), config.tag, profile, std::to_string(count), "untyped"};
  }

  void scanner_with(const char* profile) {
    composition_.add("main", "scanner", scanner,
                     {binding<LaserScan>("out", PortDirection::output, "/scan", *kervan::builtin_profile(profile))});
  }
  void mapper_with(const char* profile) {
    composition_.add("main", "mapper", mapper,
                     {binding<LaserScan>("in", PortDirection::input, "/scan", *kervan::builtin_profile(profile))});
  }

  static std::string process(const Peer& peer) {
    char host[256] = {};
    gethostname(host, sizeof host - 1);
    return "process 'peer' (pid " + std::to_string(peer.pid()) + " on " + host + ")";
  }
};

TEST_F(Foreign, AReaderThatAsksForMoreThanIsOfferedIsNamed) {
  scanner_with("sensor");
  Running main(composition_.spec("main"), composition_.registry());
  Peer reader(peer("c-read", "event"));
  const auto& health = main.container().find("scanner")->outputs().front()->health();
  const std::string sentence =
      "incompatible with reader of " + process(reader) + ": reliability offered best_effort, requested reliable";
  EXPECT_TRUE(eventually([&] { return health.trouble() == sentence; })) << health.trouble();
  EXPECT_THAT(main.log(), HasSubstr(" warning [scanner] out on /scan: " + sentence + "\n"));
  EXPECT_EQ(reader.end(), 0);
  EXPECT_TRUE(eventually([&] { return health.trouble().empty(); }));
}

TEST_F(Foreign, AWriterOfAnotherTypeIsNamed) {
  mapper_with("sensor");
  Running main(composition_.spec("main"), composition_.registry());
  Peer writer(peer("c-write-other", "event", 1));
  const auto& health = main.container().find("mapper")->inputs().front()->health();
  const std::string sentence =
      "writer of " + process(writer) + " has type wire_test::ShortScan, this port sensor_msgs::msg::LaserScan";
  EXPECT_TRUE(eventually([&] { return health.trouble() == sentence; })) << health.trouble();
}

TEST_F(Foreign, SamplesThatAreNoMessageAreCountedAndTheirWriterIsNamed) {
  mapper_with("event");
  Running main(composition_.spec("main"), composition_.registry());
  ASSERT_TRUE(eventually([&] { return main.has_reached(RunPhase::active); }));
  Peer liar(peer("c-write-short", "event", 5));
  ASSERT_TRUE(eventually([&] { return liar.has_said("acknowledged"); }));
  const auto& port = *main.container().find("mapper")->inputs().front();
  const std::string sentence =
      "samples of writer of " + process(liar) + " are no sensor_msgs::msg::LaserScan as this port knows it";
  EXPECT_TRUE(eventually([&] { return port.health().undecodable() == 5; }));
  EXPECT_TRUE(eventually([&] { return port.health().trouble() == sentence; })) << port.health().trouble();
  EXPECT_THAT(main.log(), ::testing::Not(HasSubstr("Cyclone"))) << "said once is enough";
}

TEST_F(Foreign, CyclonesOwnLinesAppearInTheLogButNotInFloods) {
  mapper_with("event");
  Running main(composition_.spec("main"), composition_.registry());
  ASSERT_TRUE(eventually([&] { return main.has_reached(RunPhase::active); }));
  for (int i = 0; i < 50; ++i) dds_log(DDS_LC_WARNING, __FILE__, __LINE__, __func__, "no space for sample %d\n", i);
  dds_log(DDS_LC_ERROR, __FILE__, __LINE__, __func__, "something else\n");
  EXPECT_TRUE(eventually([&] { return main.log().find("something else") != std::string::npos; }));
  EXPECT_THAT(main.log(), HasSubstr(" warning [kervan/main] Cyclone DDS: no space for sample 0\n"));
  EXPECT_THAT(main.log(), HasSubstr(" error [kervan/main] Cyclone DDS: something else\n"));
  EXPECT_THAT(main.log(), ::testing::Not(HasSubstr("sample 1")));
}

TEST_F(Foreign, SamplesThatNeverCameAreCounted) {
  mapper_with("sensor");
  Running main(composition_.spec("main"), composition_.registry());
  ASSERT_TRUE(eventually([&] { return main.has_reached(RunPhase::active); }));
  kervan::dds::Domain domain(composition_.spec("writer").domain);
  kervan::dds::Writer writer(domain, "/scan", kervan::type_support<LaserScan>(), *kervan::builtin_profile("sensor"),
                             kervan::dds::CyclonePart::whole_profile, 0, kervan::dds::kInternal);
  const auto& port = *main.container().find("mapper")->inputs().front();
  ASSERT_TRUE(eventually([&] { return writer.status().matched == 1 && port.reader().status().matched == 1; }));
  const auto received = [&] { return port.counters().received; };
  const auto publish = [&] { writer.publish(writer.loan(true), kervan::dds::wall_now(), false); };
  publish();
  ASSERT_TRUE(eventually([&] { return received() == 1; }));
  EXPECT_EQ(port.counters().lost, 0u);
  // The writer is mute: a deaf reader would still find in its socket's buffer what it had no time to throw away.
  const dds_entity_t mute = domain.participant();
  ASSERT_EQ(dds_domain_set_deafmute(mute, false, true, DDS_INFINITY), DDS_RETCODE_OK);
  for (int i = 0; i < 4; ++i) publish();
  ASSERT_EQ(dds_domain_set_deafmute(mute, false, false, DDS_INFINITY), DDS_RETCODE_OK);
  ASSERT_TRUE(eventually([&] {
    publish();
    return received() > 1;
  }));
  EXPECT_GE(port.counters().lost, 1u);
  EXPECT_LE(port.counters().lost, 4u);
}

}  // namespace
