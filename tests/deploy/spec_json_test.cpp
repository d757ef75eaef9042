// A specification comes back from its file as it was, and a file that is broken is refused with the place.
#include "deploy/container/spec_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "framework/component/error.hpp"

namespace kervan::container {
namespace {

runtime::ContainerSpec full_spec() {
  runtime::ContainerSpec spec;
  spec.name = "brain";
  spec.members = {"sim", "brain"};
  spec.clock = runtime::ClockMode::sim;
  spec.pace = 0.1 + 0.2;
  spec.threads = 3;
  spec.domain = {.id = 17,
                 .network = true,
                 .interface = "",
                 .address = "10.0.0.10",
                 .tag = "a \"tag\"",
                 .peers = {"10.0.0.11", "10.0.0.12"},
                 .multicast = dds::DomainConfig::Multicast::discovery_only,
                 .processes = 20,
                 .external_id = 4,
                 .linger = std::chrono::milliseconds(20),
                 .user_data = "kc=brain;"};
  spec.run_folder = "/runs/läb";
  spec.log_to_console = false;
  spec.publish_log = false;
  runtime::ComponentSpec component{.name = "r1/control", .type = "control/potential_field", .container = "brain"};
  component.parameters = {{"nothing", Value()},
                          {"yes", true},
                          {"no", false},
                          {"whole", std::int64_t{1}},
                          {"least", std::numeric_limits<std::int64_t>::min()},
                          {"most", std::numeric_limits<std::int64_t>::max()},
                          {"one", 1.0},
                          {"third", 1.0 / 3.0},
                          {"zero", -0.0},
                          {"tiny", std::numeric_limits<double>::denorm_min()},
                          {"infinite", std::numeric_limits<double>::infinity()},
                          {"below", -std::numeric_limits<double>::infinity()},
                          {"text", "line\nbreak \\ \" ü"},
                          {"empty text", ""},
                          {"list", ValueList{1, 2.0, "three", ValueList{}, ValueMap{}}},
                          {"map", ValueMap{{"$number", "nan"}, {"$", 1}, {"deep", ValueMap{{"er", ValueList{true}}}}}}};
  component.log_level = "debug";
  QosProfile profile;
  profile.name = "radio";
  profile.reliability = Reliability::best_effort;
  profile.durability = Durability::transient_local;
  profile.depth = 7;
  profile.limit = 70;
  profile.deadline = Duration(123456789);
  profile.lifespan = Duration(1);
  profile.liveliness = Liveliness::manual;
  profile.lease = Duration(200);
  profile.ownership = Ownership::exclusive;
  profile.partition = {"a", "b"};
  profile.network = Network::async;
  profile.trace = false;
  component.ports.push_back({.port = "sonar",
                             .topic = "/r1/sonar",
                             .profile = profile,
                             .direction = PortDirection::output,
                             .type = "sensor_msgs::msg::Range",
                             .layout_hash = 0xfedcba9876543210U,
                             .optional = true,
                             .strength = 7});
  component.ports.push_back({.port = "goal", .topic = "/r1/goal", .profile = *builtin_profile("latched")});
  spec.components.push_back(component);
  spec.components.push_back({.name = "world", .type = "sim/world", .container = "sim"});
  return spec;
}

TEST(SpecJson, GivesEverythingBackAsItWas) {
  const runtime::ContainerSpec spec = full_spec();
  const runtime::ContainerSpec back = spec_from_json(to_json(spec), "spec");
  EXPECT_EQ(back.name, spec.name);
  EXPECT_EQ(back.members, spec.members);
  EXPECT_EQ(back.clock, spec.clock);
  EXPECT_EQ(back.pace, spec.pace);
  EXPECT_EQ(back.threads, spec.threads);
  EXPECT_EQ(back.domain.id, spec.domain.id);
  EXPECT_EQ(back.domain.network, spec.domain.network);
  EXPECT_EQ(back.domain.interface, spec.domain.interface);
  EXPECT_EQ(back.domain.tag, spec.domain.tag);
  EXPECT_EQ(back.domain.address, spec.domain.address);
  EXPECT_EQ(back.domain.peers, spec.domain.peers);
  EXPECT_EQ(back.domain.multicast, spec.domain.multicast);
  EXPECT_EQ(back.domain.processes, spec.domain.processes);
  EXPECT_EQ(back.domain.external_id, spec.domain.external_id);
  EXPECT_EQ(back.domain.linger, spec.domain.linger);
  EXPECT_EQ(back.domain.user_data, spec.domain.user_data);
  EXPECT_EQ(back.run_folder, spec.run_folder);
  EXPECT_EQ(back.log_to_console, spec.log_to_console);
  EXPECT_EQ(back.publish_log, spec.publish_log);
  ASSERT_EQ(back.components.size(), spec.components.size());
  const runtime::ComponentSpec &one = back.components.front(), &given = spec.components.front();
  EXPECT_EQ(one.name, given.name);
  EXPECT_EQ(one.type, given.type);
  EXPECT_EQ(one.container, given.container);
  EXPECT_EQ(one.log_level, given.log_level);
  for (const auto& [name, value] : given.parameters) {
    ASSERT_TRUE(one.parameters.contains(name)) << name;
    EXPECT_EQ(one.parameters.at(name), value) << name;
    EXPECT_EQ(one.parameters.at(name).index(), value.index()) << name << " has become another kind";
  }
  EXPECT_EQ(one.parameters.size(), given.parameters.size());
  EXPECT_TRUE(std::signbit(std::get<double>(one.parameters.at("zero"))));
  ASSERT_EQ(one.ports.size(), given.ports.size());
  for (std::size_t i = 0; i < one.ports.size(); ++i) {
    EXPECT_EQ(one.ports[i].port, given.ports[i].port);
    EXPECT_EQ(one.ports[i].topic, given.ports[i].topic);
    EXPECT_EQ(one.ports[i].profile, given.ports[i].profile);
    EXPECT_EQ(one.ports[i].direction, given.ports[i].direction);
    EXPECT_EQ(one.ports[i].type, given.ports[i].type);
    EXPECT_EQ(one.ports[i].layout_hash, given.ports[i].layout_hash);
    EXPECT_EQ(one.ports[i].optional, given.ports[i].optional);
    EXPECT_EQ(one.ports[i].strength, given.ports[i].strength);
  }
  EXPECT_EQ(to_json(back), to_json(spec));
}

TEST(SpecJson, KeepsANumberThatIsNone) {
  runtime::ContainerSpec spec;
  spec.components.push_back({.name = "c", .type = "t/t", .parameters = {{"x", std::nan("")}}});
  const Value back = spec_from_json(to_json(spec), "spec").components.front().parameters.at("x");
  EXPECT_TRUE(std::isnan(std::get<double>(back)));
}

struct Broken {
  const char* name;
  const char* from;
  const char* to;
  const char* message;
};

void PrintTo(const Broken& broken, std::ostream* out) { *out << broken.name; }

class BrokenSpec : public testing::TestWithParam<Broken> {};

TEST_P(BrokenSpec, IsRefusedWithFileAndKey) {
  std::string text = to_json(full_spec());
  const auto at = text.find(GetParam().from);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::string(GetParam().from).size(), GetParam().to);
  try {
    spec_from_json(text, "brain.json");
    FAIL() << "it was accepted";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), GetParam().message);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, BrokenSpec,
    testing::Values(
        Broken{"NoJson", "\"name\"", "name", "brain.json:2:3: this is no JSON"},
        Broken{"Missing", "\"members\"", "\"embers\"",
               "brain.json: unknown key 'embers'; this program and the one that wrote it differ"},
        Broken{"WrongType", "\"threads\": 3", "\"threads\": \"3\"", "brain.json: threads: must be an integer"},
        Broken{"TooLarge", "\"threads\": 3", "\"threads\": 5000000000", "brain.json: threads: the number is too large"},
        Broken{"Negative", "\"threads\": 3", "\"threads\": -3", "brain.json: threads: the number is out of range"},
        Broken{"Clock", "\"clock\": \"sim\"", "\"clock\": \"sun\"",
               "brain.json: clock: 'sun' is not one of wall, sim, lockstep"},
        Broken{"Profile", "\"depth\": 7", "\"depth\": true",
               "brain.json: components[0].ports[0].profile.depth: must be an integer"},
        Broken{"Reliability", "\"best_effort\"", "\"best\"",
               "brain.json: components[0].ports[0].profile.reliability: 'best' is not one of best_effort, reliable"},
        Broken{"Hash", "\"fedcba9876543210\"", "\"fedcba987654321\"",
               "brain.json: components[0].ports[0].layout_hash: must be 16 hexadecimal digits"},
        Broken{"Flag", "\"optional\": true", "\"optional\": 1",
               "brain.json: components[0].ports[0].optional: must be true or false"}),
    [](const auto& test) { return test.param.name; });

TEST(SpecFile, ThatIsNotThereIsNamed) {
  try {
    read_spec("/nowhere/spec.json");
    FAIL() << "it was read";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "/nowhere/spec.json: cannot be read");
  }
}

}  // namespace
}  // namespace kervan::container
