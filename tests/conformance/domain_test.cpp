// What Cyclone DDS is told about the network, and that it takes it.
#include "framework/dds/domain.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "framework/component/error.hpp"

namespace {

using namespace std::chrono_literals;
using kervan::ConfigError;
using kervan::dds::cyclone_configuration;
using kervan::dds::Domain;
using kervan::dds::DomainConfig;
using Multicast = DomainConfig::Multicast;

const std::string acks =
    "<Internal><PreEmptiveAckDelay>0s</PreEmptiveAckDelay><NackDelay>10ms</NackDelay>"
    "<WriterLingerDuration>1000ms</WriterLingerDuration></Internal>";

std::string index_and_lease(int last) {
  return "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>" + std::to_string(last) +
         "</MaxAutoParticipantIndex><LeaseDuration>2s</LeaseDuration>";
}

TEST(CycloneConfiguration, OfOneProcessHasNoNetworkAtAll) {
  EXPECT_EQ(cyclone_configuration({.network = false}), "<General><Transport>none</Transport></General>");
}

TEST(CycloneConfiguration, OfTheLoopbackInterfaceHasMulticastAndLargeDatagrams) {
  EXPECT_EQ(cyclone_configuration({}),
            "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/></Interfaces>"
            "<MaxMessageSize>65000B</MaxMessageSize></General><Discovery>" +
                index_and_lease(119) + "</Discovery>" + acks);
}

TEST(CycloneConfiguration, OfSeveralHostsNamesThemAsPeers) {
  EXPECT_EQ(cyclone_configuration({.interface = "",
                                   .address = "10.0.0.1",
                                   .peers = {"10.0.0.2", "robot.local"},
                                   .multicast = Multicast::discovery_only,
                                   .processes = 18}),
            "<General><Interfaces><NetworkInterface address=\"10.0.0.1\"/></Interfaces>"
            "<AllowMulticast>spdp</AllowMulticast></General><Discovery>" +
                index_and_lease(17) +
                "<Peers><Peer address=\"10.0.0.2\"/><Peer address=\"robot.local\"/></Peers></Discovery>" + acks);
}

TEST(CycloneConfiguration, WithoutMulticastHasNoneOnTheLoopbackInterfaceEither) {
  EXPECT_EQ(cyclone_configuration({.peers = {"127.0.0.1"}, .multicast = Multicast::no, .processes = 1}),
            "<General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces><AllowMulticast>false</AllowMulticast>"
            "<MaxMessageSize>65000B</MaxMessageSize></General><Discovery>" +
                index_and_lease(0) + "<Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>" + acks);
}

TEST(CycloneConfiguration, OfAnInterfaceByNameHasItsOwnMulticastAndSizes) {
  EXPECT_EQ(cyclone_configuration({.interface = "eth0", .address = "10.0.0.1", .linger = 0ms}),
            "<General><Interfaces><NetworkInterface name=\"eth0\"/></Interfaces></General><Discovery>" +
                index_and_lease(119) +
                "</Discovery><Internal><PreEmptiveAckDelay>0s</PreEmptiveAckDelay><NackDelay>10ms</NackDelay>"
                "<WriterLingerDuration>0ms</WriterLingerDuration></Internal>");
}

TEST(CycloneConfiguration, TagAndNumberOnTheNetworkComeFirstAndTextsAreEscaped) {
  EXPECT_EQ(cyclone_configuration({.tag = "a<b>&\"c\"", .external_id = 7}),
            "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/></Interfaces>"
            "<MaxMessageSize>65000B</MaxMessageSize></General><Discovery><ExternalDomainId>7</ExternalDomainId>"
            "<Tag>a&lt;b&gt;&amp;&quot;c&quot;</Tag>" +
                index_and_lease(119) + "</Discovery>" + acks);
}

std::string refusal_of(const DomainConfig& config) {
  try {
    cyclone_configuration(config);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(CycloneConfiguration, RefusesWhatNoNetworkHas) {
  EXPECT_EQ(refusal_of({.id = 233}), "domain.id: 233 is out of range; allowed: 0 .. 232");
  EXPECT_EQ(refusal_of({.id = 233, .external_id = 232}), "");
  EXPECT_EQ(refusal_of({.external_id = 400}), "domain.external_id: 400 is out of range; allowed: 0 .. 232");
  EXPECT_EQ(refusal_of({.processes = 0}), "domain.processes: 0 is out of range; allowed: 1 .. 120");
  EXPECT_EQ(refusal_of({.processes = 121}), "domain.processes: 121 is out of range; allowed: 1 .. 120");
  EXPECT_EQ(refusal_of({.interface = ""}), "domain: needs the name of a network interface or its address");
  EXPECT_EQ(refusal_of({.peers = {"10.0.0.1", ""}}), "domain.peers: an address is empty");
  EXPECT_EQ(refusal_of({.linger = -1ms}), "domain.linger: must not be negative");
}

TEST(CycloneConfiguration, IsTakenWithoutAWord) {
  const std::string tag = "domain_test <&> " + std::to_string(getpid());
  for (const DomainConfig& config :
       {DomainConfig{.id = 1, .network = false}, DomainConfig{.id = 2, .tag = tag},
        DomainConfig{.id = 3, .tag = tag, .peers = {"127.0.0.1"}, .multicast = Multicast::no, .processes = 60},
        DomainConfig{.id = 4,
        .interface = "",
        .address = "127.0.0.1",
        .tag = tag,
        .peers = {"127.0.0.1"},
        .multicast = Multicast::no,
        .external_id = 5,
        .linger = 0ms}}) {
    Domain domain(config);
    domain.reports().listen([] {});
    for (const auto& line : domain.reports().take_lines()) ADD_FAILURE() << "domain " << config.id << ": " << line.text;
  }
}

TEST(CycloneConfiguration, OfAnInterfaceThatIsNotThereIsRefusedByName) {
  try {
    Domain domain({.id = 6, .interface = "no_such_if"});
    ADD_FAILURE() << "it was taken";
  } catch (const kervan::dds::DdsError& error) {
    EXPECT_STREQ(error.what(),
                 "cannot create the DDS domain (domain 6, interface no_such_if): Error; no_such_if: does not match an "
                 "available interface.");
  }
}

}  // namespace
