// What a good composition becomes: arguments, templates, remaps, quality of service, containers.
#include <gtest/gtest.h>

#include "deploy/composition/hosts.hpp"
#include "deploy/composition/load.hpp"
#include "tests/composition/fake_components.hpp"

using namespace kervan;
using namespace kervan::composition;
using namespace std::chrono_literals;

namespace {

Composition loaded(const std::string& yaml, const LoadOptions& options = {}) {
  return load_text(yaml, "c.yaml", std::filesystem::path(COMPOSITION_TESTS) / "worlds", options);
}

ResolvedComposition resolved(const std::string& yaml, const LoadOptions& options = {},
                             const ResolveOptions& resolving = {}) {
  test::FakeComponents components;
  return resolve(loaded(yaml, options), components, resolving);
}

const ResolvedComponent& component(const ResolvedComposition& composition, const std::string& name) {
  for (const ResolvedComponent& component : composition.components)
    if (component.name == name) return component;
  throw std::runtime_error("no component " + name);
}

std::string topic(const ResolvedComposition& composition, const std::string& name, const std::string& port) {
  for (const ResolvedPort& candidate : component(composition, name).ports)
    if (candidate.info.name == port) return candidate.topic;
  return "no such port";
}

QosValue value(const ResolvedComposition& composition, const std::string& topic_name, const std::string& key) {
  for (const QosValue& value : composition.topics.at(topic_name).qos.values)
    if (value.name == key) return value;
  return {};
}

const std::string lab = R"(kervan: 1
name: lab
args:
  law:   {type: enum, values: [classical, ge_cui], default: ge_cui, help: force law}
  seed:  {type: int, default: 1, range: [0, 4294967295]}
  speed: {type: number, unit: m/s, default: 0.5 m/s, range: [0 m/s, 1 m/s]}
  start: {type: pose, default: [0 m, 0 m, 0 deg]}
clock: {mode: lockstep, step: 10ms}
domain: {id: 17, hosts: {base: {interface: lo}, far: {address: 10.0.0.11}}}
qos:
  radio: {extends: slow, depth: 3}
  slow: {extends: sensor, deadline: 400ms}
topics:
  "/r1/*": {lifespan: 300ms}
  "/r1/sonar": {qos: radio, lifespan: 200ms}
templates:
  robot:
    params: {law: {type: enum, values: [classical, ge_cui]}, at: {type: points, default: [[1 m, 1 m], [2 m, 2 m]]}}
    components:
      planner: {type: planning/astar, params: {nodes: "${at}", edges: [[0, 1]]}}
      control: {type: control/field, params: {law: "${law}"}, remap: {goal: planner/waypoint}, log: debug}
components:
  world: {type: sim/world, params: {map: world.yaml, seed: "${seed}", robots: {r1: {start: "${start}"}}}}
  r1:
    template: robot
    with: {law: classical}
    set: {control.params.speed: "${speed}", planner.log: trace}
containers:
  sim:   {host: base, components: [world]}
  brain: {host: far, components: ["r*"], threads: 2, restart: {policy: on-failure, max: 3, window: 10s}}
mission: {goals: [[9 m, 9 m]], timeout: 60s}
)";

std::string with_law(std::string yaml) {
  // The template's parameter and the composition's argument must not share a name.
  const auto at = yaml.find("  law:   {type");
  return yaml.erase(at, yaml.find('\n', at) + 1 - at);
}

TEST(Composition, OfTheWholeFormatHasNothingToReport) {
  const auto composition = resolved(with_law(lab));
  for (const Finding& finding : composition.findings)
    ADD_FAILURE() << to_text(finding.location) << ": " << finding.message;
  EXPECT_TRUE(composition.usable());
  EXPECT_EQ(composition.components.size(), 4u);
}

TEST(Composition, KeepsTheOrderOfTheFileWithTheMissionLast) {
  const auto composition = loaded(with_law(lab));
  std::vector<std::string> names;
  for (const ComponentEntry& entry : composition.components) names.push_back(entry.name);
  EXPECT_EQ(names, (std::vector<std::string>{"world", "r1/planner", "r1/control", "mission"}));
}

TEST(Composition, ReadsClockDomainAndLogLevels) {
  const auto composition = loaded(with_law(lab));
  EXPECT_EQ(composition.clock.mode, ClockMode::lockstep);
  EXPECT_EQ(composition.clock.step, 10ms);
  EXPECT_EQ(composition.domain.id, 17);
  EXPECT_EQ(composition.domain.hosts.at(1).address, "10.0.0.11");
  EXPECT_EQ(composition.component("world")->log_level, "info");
  EXPECT_EQ(composition.component("r1/control")->log_level, "debug");
  EXPECT_EQ(composition.component("r1/planner")->log_level, "trace");
}

TEST(Arguments, AreFilledInFromTheDefaultOrTheCommandLine) {
  EXPECT_EQ(component(resolved(with_law(lab)), "world").parameters.at("seed"), Value(1));
  const auto given = resolved(with_law(lab), {{"seed=42", "speed=75 cm/s", "start=[1 m, 2 m, 0 deg]"}});
  EXPECT_EQ(component(given, "world").parameters.at("seed"), Value(42));
  EXPECT_EQ(component(given, "r1/control").parameters.at("speed"), Value(0.75));
  EXPECT_EQ(to_text(component(given, "world").parameters.at("robots")), "{r1: {start: [1, 2, 0]}}");
}

TEST(Arguments, MayBePartOfALongerText) {
  const auto composition = resolved(R"(kervan: 1
name: c
args: {controller: {type: enum, values: [field, pursuit], default: field}}
components:
  control: {type: "control/${controller}", remap: {odom: "/${controller}/odom"}}
)",
                                    {{"controller=pursuit"}});
  EXPECT_EQ(composition.components[0].manifest.type, "control/pursuit");
  EXPECT_EQ(topic(composition, "control", "odom"), "/pursuit/odom");
}

TEST(Templates, FillInTheirParametersAndTakeSettings) {
  const auto composition = resolved(with_law(lab));
  const auto& control = component(composition, "r1/control").parameters;
  EXPECT_EQ(control.at("law"), Value("classical"));
  EXPECT_EQ(control.at("speed"), Value(0.5));
  EXPECT_EQ(to_text(component(composition, "r1/planner").parameters.at("nodes")), "[[1, 1], [2, 2]]");
}

TEST(Templates, RefuseAParameterThatHidesAnArgument) {
  try {
    loaded(lab);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(),
                 "c.yaml:18:14: 'law' is already an argument of the composition (c.yaml:4:3); use another name");
  }
}

TEST(Topics, ComeFromTheScopeOfTheComponent) {
  const auto composition = resolved(with_law(lab));
  EXPECT_EQ(topic(composition, "r1/control", "sonar"), "/r1/sonar");
  EXPECT_EQ(topic(composition, "world", "r1/cmd_vel"), "/r1/cmd_vel");
  EXPECT_EQ(topic(composition, "world", "/clock"), "/clock");
}

TEST(Topics, HaveTheRobotsPrefixUnlessAnAbsoluteNameIsAskedFor) {
  const auto composition = resolved(R"(kervan: 1
name: c
templates:
  robot:
    components:
      guard: {type: safety/guard, remap: {cmd_vel_raw: pursuit/cmd_vel}}
      pursuit: {type: control/pursuit, remap: {odom: truth, goal: /goal}}
components: {r1: {template: robot}, r2: {template: robot}}
)");
  for (const std::string robot : {"r1", "r2"}) {
    EXPECT_EQ(topic(composition, robot + "/guard", "cmd_vel"), "/" + robot + "/cmd_vel");
    EXPECT_EQ(topic(composition, robot + "/guard", "cmd_vel_raw"), "/" + robot + "/cmd_vel");
    EXPECT_EQ(topic(composition, robot + "/pursuit", "odom"), "/" + robot + "/truth");
    EXPECT_EQ(topic(composition, robot + "/pursuit", "goal"), "/goal");
  }
}

TEST(Remaps, NameATopicOrAnotherPortOfTheScope) {
  const auto composition = resolved(R"(kervan: 1
name: c
components:
  a: {type: control/pursuit, remap: {goal: b/goal, cmd_vel: /out, odom: left/odom}}
  b: {type: control/pursuit, remap: {goal: planner/waypoint, odom: "/left/odom"}}
  planner: {type: planning/astar, remap: {waypoint: way/point}}
)");
  EXPECT_EQ(topic(composition, "a", "goal"), "/way/point");
  EXPECT_EQ(topic(composition, "b", "goal"), "/way/point");
  EXPECT_EQ(topic(composition, "a", "cmd_vel"), "/out");
  EXPECT_EQ(topic(composition, "a", "odom"), "/left/odom");
}

TEST(Qos, OfATopicSaysWhichLineGaveEachValue) {
  const auto composition = resolved(with_law(lab));
  const auto& sonar = composition.topics.at("/r1/sonar").qos.profile;
  EXPECT_EQ(sonar.name, "radio");
  EXPECT_EQ(sonar.depth, 3);
  EXPECT_EQ(sonar.deadline, 400ms);
  EXPECT_EQ(sonar.lifespan, 200ms);
  EXPECT_EQ(value(composition, "/r1/sonar", "reliability").origin, "built-in profile sensor");
  EXPECT_EQ(value(composition, "/r1/sonar", "depth").origin, "c.yaml:10:33 (profile radio)");
  EXPECT_EQ(value(composition, "/r1/sonar", "deadline").origin, "c.yaml:11:37 (profile slow)");
  EXPECT_EQ(value(composition, "/r1/sonar", "lifespan").origin, "c.yaml:14:39 (topic /r1/sonar)");
  EXPECT_EQ(value(composition, "/r1/sonar", "network").origin, "default for kervan_msgs");
}

TEST(Qos, IsTheOneDeclaredByTheWriterUnlessTheCompositionSaysOtherwise) {
  const auto composition = resolved(with_law(lab));
  EXPECT_EQ(composition.topics.at("/r1/waypoint").qos.profile.name, "latched");
  EXPECT_EQ(value(composition, "/r1/waypoint", "durability").origin,
            "profile latched, declared by r1/planner.waypoint");
  EXPECT_EQ(value(composition, "/r1/waypoint", "lifespan").origin, "c.yaml:13:23 (topic /r1/*)");
}

TEST(Qos, SaysWhereLivelinessPartitionAndLimitComeFrom) {
  const auto composition = resolved(R"(kervan: 1
name: c
qos: {guarded: {extends: event, depth: all, limit: 50, liveliness: manual, lease: 300ms, partition: [r1, "lab*"]}}
topics:
  "/r1/*": {qos: guarded}
  "/r1/odom": {qos: guarded, partition: none, lease: 1s}
components: {world: {type: sim/world, params: {map: world.yaml, robots: {r1: {start: [0 m, 0 m, 0 deg]}}}}}
)");
  const QosProfile& odom = composition.topics.at("/r1/odom").qos.profile;
  EXPECT_EQ(odom.liveliness, Liveliness::manual);
  EXPECT_EQ(odom.lease, 1s);
  EXPECT_EQ(odom.limit, 50);
  EXPECT_TRUE(odom.partition.empty());
  EXPECT_EQ(value_and_origin(value(composition, "/r1/odom", "limit")), "50, from c.yaml:3:52 (profile guarded)");
  EXPECT_EQ(value_and_origin(value(composition, "/r1/odom", "lease")), "1 s, from c.yaml:6:54 (topic /r1/odom)");
  EXPECT_EQ(value_and_origin(value(composition, "/r1/sonar", "partition")),
            "[r1, lab*], from c.yaml:3:101 (profile guarded)");
}

TEST(Qos, OfAReliableReaderOnABestEffortTopicIsAWarning) {
  const auto composition = resolved(R"(kervan: 1
name: c
topics: {"/r1/cmd_vel": {reliability: best_effort}}
components:
  world: {type: sim/world, params: {map: world.yaml, robots: {r1: {start: [0 m, 0 m, 0 deg]}}}}
  planner: {type: planning/astar, remap: {odom: /r1/odom}}
  control: {type: control/pursuit, remap: {odom: /r1/odom, goal: planner/waypoint, cmd_vel: /r1/cmd_vel}}
)");
  ASSERT_EQ(composition.findings.size(), 1u);
  EXPECT_EQ(composition.findings[0].severity, Severity::warning);
  EXPECT_EQ(composition.findings[0].message,
            "world.r1/cmd_vel on '/r1/cmd_vel': it expects a reliable topic, but its reliability is best_effort, from "
            "c.yaml:3:39 (topic /r1/cmd_vel): samples may be lost");
  EXPECT_TRUE(composition.usable());
}

TEST(Matrix, HoldsEveryWriterWithEveryReaderAndWhoHasNone) {
  const auto composition = resolved(with_law(lab));
  std::vector<std::string> lines;
  for (const Pair& pair : composition.pairs)
    lines.push_back(pair.topic + " " + pair.writer + " " + pair.reader + " " + pair.profile + " " + pair.verdict);
  EXPECT_EQ(lines, (std::vector<std::string>{
                       "/clock world./clock  state nobody reads it",
                       "/r1/cmd_vel r1/control.cmd_vel world.r1/cmd_vel command ok",
                       "/r1/odom world.r1/odom r1/planner.odom sensor ok",
                       "/r1/odom world.r1/odom r1/control.odom sensor ok",
                       "/r1/route r1/planner.route  latched nobody reads it",
                       "/r1/sonar world.r1/sonar r1/control.sonar radio ok",
                       "/r1/waypoint r1/planner.waypoint r1/control.goal latched ok",
                   }));
}

TEST(Inputs, WithoutAWriterAreFineWhenItIsOutsideOfTheComposition) {
  const std::string log = "components: {log: {type: observe/log}}\n";
  const std::string head = "kervan: 1\nname: c\n";
  EXPECT_FALSE(resolved(head + log).usable());
  EXPECT_TRUE(resolved(head + log, {}, {{}, {"/rosout"}}).usable());
  EXPECT_TRUE(resolved(head + "topics: {/rosout: {external: true}}\n" + log).usable());
}

TEST(Containers, HoldEveryComponentOnce) {
  const auto composition = loaded(with_law(lab));
  ASSERT_EQ(composition.containers.size(), 2u);
  EXPECT_EQ(composition.containers[0].components, (std::vector<std::string>{"world", "mission"}));
  EXPECT_EQ(composition.containers[1].components, (std::vector<std::string>{"r1/planner", "r1/control"}));
  EXPECT_EQ(composition.containers[1].threads, 2);
  EXPECT_EQ(composition.containers[1].restart.max, 3);
  EXPECT_EQ(component(resolved(with_law(lab)), "r1/control").container, "brain");
}

TEST(Containers, BecomeOneWithPlaceAll) {
  const auto composition = loaded(with_law(lab), {{}, {"all"}});
  ASSERT_EQ(composition.containers.size(), 1u);
  EXPECT_EQ(composition.containers[0].name, "all");
  EXPECT_EQ(composition.containers[0].components.size(), 4u);
}

std::map<std::string, std::vector<std::string>> placed(const std::vector<std::string>& options,
                                                       const std::string& yaml) {
  std::map<std::string, std::vector<std::string>> containers;
  for (const Container& container : loaded(yaml, {.place = options}).containers)
    containers[container.name] = container.components;
  return containers;
}

TEST(Placement, MovesTheComponentsItNamesAndLeavesTheOthers) {
  using Containers = std::map<std::string, std::vector<std::string>>;
  EXPECT_EQ(placed({"sim=r1/planner"}, with_law(lab)),
            (Containers{{"sim", {"world", "r1/planner", "mission"}}, {"brain", {"r1/control"}}}));
  EXPECT_EQ(placed({"sim=r*,mission"}, with_law(lab)),
            (Containers{{"sim", {"world", "r1/planner", "r1/control", "mission"}}}))
      << "a container that lost all its components is gone";
  EXPECT_EQ(placed({"all", "drive=r1/control", "plan=r1/planner"}, with_law(lab)),
            (Containers{{"all", {"world", "mission"}}, {"drive", {"r1/control"}}, {"plan", {"r1/planner"}}}));
}

TEST(Placement, GivesEachComponentAContainerThatKeepsHostThreadsAndRestart) {
  const auto composition = loaded(with_law(lab), {.place = {"each"}});
  std::vector<std::string> names;
  for (const Container& container : composition.containers) names.push_back(container.name);
  EXPECT_EQ(names, (std::vector<std::string>{"world", "r1_planner", "r1_control", "mission"}));
  EXPECT_EQ(composition.containers[2].host, "far");
  EXPECT_EQ(composition.containers[2].threads, 2);
  EXPECT_EQ(composition.containers[2].restart.max, 3);
}

TEST(Placement, OfAFileWithoutContainersSplitsThemOff) {
  const std::string yaml =
      "kervan: 1\nname: c\ncomponents: {a: {type: sim/ghost}, b: {type: sim/ghost}, c: {type: sim/ghost}}\n";
  EXPECT_EQ(placed({"left=a", "right=b"}, yaml),
            (std::map<std::string, std::vector<std::string>>{{"all", {"c"}}, {"left", {"a"}}, {"right", {"b"}}}));
}

std::string hosts(const std::string& domain, const std::string& containers) {
  return "kervan: 1\nname: c\ndomain: " + domain + "\ncontainers: " + containers +
         "\ncomponents: {a: {type: sim/ghost}, b: {type: sim/ghost}, c: {type: sim/ghost}}\n";
}

const std::string two_hosts = "{base: {address: 10.0.0.1, interface: eth0}, robot: {address: 10.0.0.2}}";
const std::string on_two_hosts =
    "{one: {host: base, components: [a]}, two: {host: robot, components: [b]}, three: {host: robot, components: [c]}}";

TEST(Hosts, FindEachOtherByTheirAddresses) {
  using Multicast = HostNetwork::Multicast;
  const auto composition = loaded(hosts("{hosts: " + two_hosts + "}", on_two_hosts));
  const HostNetwork base = network_of(composition, composition.containers[0]);
  EXPECT_EQ(base.interface, "eth0");
  EXPECT_EQ(base.peers, (std::vector<std::string>{"10.0.0.2", "10.0.0.1"})) << "others, and whoever else is here";
  EXPECT_EQ(base.multicast, Multicast::discovery_only);
  const HostNetwork robot = network_of(composition, composition.containers[1]);
  EXPECT_EQ(robot.interface, "");
  EXPECT_EQ(robot.address, "10.0.0.2");
  EXPECT_EQ(robot.peers, (std::vector<std::string>{"10.0.0.1", "10.0.0.2"}));
  EXPECT_EQ(robot.processes, base.processes) << "each must look at every port that the other may have";
  EXPECT_EQ(robot.processes, 2 + 16);
}

TEST(Hosts, WithoutMulticastLookForThemselvesToo) {
  const auto composition = loaded(hosts("{multicast: false, hosts: " + two_hosts + "}", on_two_hosts));
  const HostNetwork robot = network_of(composition, composition.containers[2]);
  EXPECT_EQ(robot.multicast, HostNetwork::Multicast::no);
  EXPECT_EQ(robot.peers, (std::vector<std::string>{"10.0.0.1", "10.0.0.2"}));
}

TEST(Hosts, AreOfNoConcernToAContainerThatHasNone) {
  const auto composition = loaded("kervan: 1\nname: c\ncomponents: {a: {type: sim/ghost}}\n");
  const HostNetwork network = network_of(composition, composition.containers[0]);
  EXPECT_EQ(network.interface, "lo");
  EXPECT_TRUE(network.peers.empty());
  EXPECT_EQ(network.processes, 120);
}

TEST(Hosts, RunTheirOwnContainersOnly) {
  const std::string yaml = hosts("{hosts: " + two_hosts + "}", on_two_hosts);
  const auto names = [](const Composition& composition) {
    std::vector<std::string> list;
    for (const Container* container : containers_here(composition)) list.push_back(container->name);
    return list;
  };
  EXPECT_EQ(names(loaded(yaml, {.host = "robot"})), (std::vector<std::string>{"two", "three"}));
  EXPECT_EQ(names(loaded(yaml, {.place = {"all"}})), (std::vector<std::string>{"all"}));
  EXPECT_EQ(names(loaded(hosts("{hosts: {left: {}, right: {}}}",
                               "{one: {host: left, components: [a, b]}, two: {host: right, components: [c]}}"))),
            (std::vector<std::string>{"one", "two"}))
      << "hosts without an address are this machine";
}

void expect_refused(const std::string& yaml, const LoadOptions& options, const std::string& message) {
  try {
    containers_here(loaded(yaml, options));
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.what(), message);
  }
}

TEST(Hosts, MustBeKnownBeforeARun) {
  expect_refused(hosts("{hosts: " + two_hosts + "}", on_two_hosts), {},
                 "c.yaml:4:50: the containers are on several hosts; say which one this is, --host base or robot, "
                 "take all of them with --place all, or let this machine play them with --emulate-hosts");
  expect_refused(hosts("{hosts: {base: {}, idle: {}}}", "{one: {host: base, components: [a, b, c]}}"), {.host = "idle"},
                 "--host idle: no container of c is on this host; there are some on base");
}

TEST(Hosts, HaveRoomForAHundredContainers) {
  std::string yaml = "kervan: 1\nname: c\ncomponents:\n";
  for (int i = 0; i < 101; ++i) yaml += "  c" + std::to_string(i) + ": {type: sim/ghost}\n";
  expect_refused(yaml, {.place = {"each"}},
                 "c.yaml:4:3: 101 containers are on one host; DDS has room for 100 there, so let some of them share a "
                 "container");
}

TEST(FindComposition, SuggestsANameAndListsWhatThereIs) {
  const std::filesystem::path folder = std::filesystem::path(COMPOSITION_TESTS) / "worlds";
  EXPECT_EQ(find_composition("world", {folder}), folder / "world.yaml");
  try {
    find_composition("wrld", {folder});
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "there is no composition 'wrld'; did you mean 'world'? there are: world");
  }
}

}  // namespace
