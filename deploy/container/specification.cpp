#include "deploy/container/specification.hpp"

#include <algorithm>

#include "deploy/composition/hosts.hpp"
#include "deploy/container/mission_listener.hpp"
#include "framework/runtime/clock_reader.hpp"

namespace kervan::container {
namespace {

constexpr const char* kMissionResultType = "kervan_msgs::msg::MissionResult";

runtime::ClockMode clock_of(const composition::Clock& clock) {
  switch (clock.mode) {
    case composition::ClockMode::wall: return runtime::ClockMode::wall;
    case composition::ClockMode::sim: return runtime::ClockMode::sim;
    case composition::ClockMode::lockstep: return runtime::ClockMode::lockstep;
  }
  return runtime::ClockMode::wall;
}

std::vector<runtime::ComponentSpec> components_of(const composition::ResolvedComposition& composition) {
  std::vector<runtime::ComponentSpec> components;
  for (const composition::ResolvedComponent& component : composition.components) {
    runtime::ComponentSpec& target = components.emplace_back();
    target.name = component.name;
    target.type = component.manifest.type;
    target.container = component.container;
    target.parameters = component.parameters;
    target.log_level = component.log_level;
    for (const composition::ResolvedPort& port : component.ports)
      target.ports.push_back({.port = port.info.name,
                              .topic = port.topic,
                              .profile = composition.topics.at(port.topic).qos.profile,
                              .direction = port.info.direction,
                              .type = port.info.type,
                              .layout_hash = port.info.layout_hash,
                              .optional = port.info.qos.is_optional(),
                              .strength = port.strength});
  }
  // Last, and beside the component it listens to: the run is the same with and without it, wherever that one runs.
  for (const auto& [name, topic] : composition.topics) {
    if (topic.type != kMissionResultType || topic.writers.empty()) continue;
    components.push_back({.name = std::string(kMissionListener),
                          .type = std::string(kMissionListener),
                          .container = composition.components[topic.writers.front().component].container,
                          .ports = {{.port = "result",
                                     .topic = name,
                                     .profile = topic.qos.profile,
                                     .type = topic.type,
                                     .layout_hash = topic.layout_hash}}});
    break;
  }
  return components;
}

dds::DomainConfig::Multicast multicast_of(composition::HostNetwork::Multicast multicast) {
  using From = composition::HostNetwork::Multicast;
  using To = dds::DomainConfig::Multicast;
  switch (multicast) {
    case From::yes: return To::yes;
    case From::discovery_only: return To::discovery_only;
    case From::no: return To::no;
  }
  return To::yes;
}

}  // namespace

std::vector<runtime::ContainerSpec> specifications(const composition::ResolvedComposition& composition,
                                                   const SpecificationOptions& options) {
  const composition::Composition& source = composition.source;
  runtime::ContainerSpec common;
  for (const composition::Container& container : source.containers) common.members.push_back(container.name);
  common.clock = clock_of(source.clock);
  common.pace = source.clock.pace;
  common.domain.id = static_cast<std::uint32_t>(source.domain.id);
  const bool lockstep = common.clock == runtime::ClockMode::lockstep;
  // A lockstep run in one container needs no network, and nobody may disturb it; one in several must not meet another.
  common.domain.network = !lockstep || common.members.size() > 1;
  common.domain.tag = source.domain.tag;
  if (lockstep && common.domain.tag.empty()) common.domain.tag = options.tag;
  common.components = components_of(composition);
  common.run_folder = options.run_folder;
  common.log_to_console = options.log_to_console;

  std::vector<runtime::ContainerSpec> specs;
  for (const composition::Container& container : source.containers) {
    runtime::ContainerSpec& spec = specs.emplace_back(common);
    spec.name = container.name;
    spec.threads = options.threads != 0 ? options.threads : static_cast<unsigned>(container.threads);
    const composition::HostNetwork network = composition::network_of(source, container);
    spec.domain.interface = network.interface;
    spec.domain.address = network.address;
    spec.domain.peers = network.peers;
    spec.domain.multicast = multicast_of(network.multicast);
    spec.domain.processes = network.processes;
  }
  return specs;
}

std::string time_keeper(const runtime::ContainerSpec& spec) {
  const auto writer = runtime::clock_writer(spec);
  return writer ? writer->container : std::string();
}

}  // namespace kervan::container
