#include "deploy/composition/hosts.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>

#include "deploy/composition/expand.hpp"

namespace kervan::composition {
namespace {

using config::Node;

/// Above this the UDP ports that DDS derives from a domain are used up; some are left to tools and drivers.
constexpr int kMostProcesses = 120;
constexpr int kMostContainers = 100;

/// Where hosts without an address are when they are emulated: 10.77.0.1 and so on.
constexpr std::uint32_t kEmulatedNetwork = 0x0a4d0000;
constexpr std::uint32_t kNetmask = 0xffffff00;

bool is_address(const std::string& text) {
  unsigned char binary[sizeof(in6_addr)];
  if (inet_pton(AF_INET, text.c_str(), binary) == 1 || inet_pton(AF_INET6, text.c_str(), binary) == 1) return true;
  // A name: not only digits and dots, which would be an address with a slip.
  const auto plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.'; };
  return !text.empty() && std::all_of(text.begin(), text.end(), plain) &&
         text.find_first_not_of("0123456789.") != std::string::npos && text.front() != '-' && text.front() != '.';
}

std::string to_text_of(std::uint32_t address) {
  const in_addr binary{htonl(address)};
  char text[INET_ADDRSTRLEN];
  return inet_ntop(AF_INET, &binary, text, sizeof text);
}

Host read_host(const Node& node) {
  require_name(node, "host");
  node.only_keys({"interface", "address"});
  Host host;
  host.name = node.name;
  host.location = node.key_location;
  if (const Node* interface = node.optional("interface")) {
    host.interface = interface->as_text();
    if (host.interface.empty() || host.interface.size() > 15)
      interface->fail(interface->shown() + " is not the name of a network interface, such as eth0");
  }
  if (const Node* address = node.optional("address")) {
    host.address = address->as_text();
    if (!is_address(host.address))
      address->fail(address->shown() + " is not an address; write e.g. 10.0.0.11, or the name of a host");
  }
  return host;
}

const Host* find(const Composition& composition, const std::string& name) {
  for (const Host& host : composition.domain.hosts)
    if (host.name == name) return &host;
  return nullptr;
}

/// How many containers each host runs; under "" those that run anywhere.
std::map<std::string, int> containers_by_host(const Composition& composition) {
  std::map<std::string, int> count;
  for (const Container& container : composition.containers) ++count[container.host];
  return count;
}

std::vector<std::string> used_hosts(const Composition& composition) {
  std::vector<std::string> names;
  for (const Host& host : composition.domain.hosts)
    if (containers_by_host(composition).contains(host.name)) names.push_back(host.name);
  return names;
}

/// Several hosts that one machine plays, as none of them has an address: for trying a composition out.
bool all_here(const Composition& composition) {
  return std::ranges::all_of(used_hosts(composition),
                             [&](const std::string& name) { return find(composition, name)->address.empty(); });
}

}  // namespace

Domain read_domain(const Node& node) {
  node.only_keys({"id", "tag", "multicast", "hosts"});
  Domain domain;
  if (const Node* id = node.optional("id")) {
    const std::int64_t value = id->as_integer();
    // Above 232 the UDP ports that DDS derives from the id no longer exist.
    if (value < 0 || value > 232) id->fail(id->shown() + " is out of range; allowed: 0 .. 232");
    domain.id = static_cast<int>(value);
  }
  if (const Node* tag = node.optional("tag")) domain.tag = tag->as_text();
  if (const Node* multicast = node.optional("multicast")) domain.multicast = multicast->as_bool();
  if (const Node* hosts = node.optional("hosts")) {
    for (const Node& given : hosts->map()) {
      Host host = read_host(given);
      for (const Host& other : domain.hosts)
        if (!host.address.empty() && other.address == host.address)
          given.required("address").fail(host.address + " is the address of '" + other.name + "' already (" +
                                         to_text(other.location) + ")");
      domain.hosts.push_back(std::move(host));
    }
  }
  return domain;
}

std::optional<std::uint32_t> ipv4(const std::string& text) {
  in_addr binary{};
  if (inet_pton(AF_INET, text.c_str(), &binary) != 1) return std::nullopt;
  return ntohl(binary.s_addr);
}

std::vector<std::string> host_names(const Domain& domain) {
  std::vector<std::string> names;
  for (const Host& host : domain.hosts) names.push_back(host.name);
  return names;
}

void emulate_hosts(Composition& composition) {
  const std::string option = "--emulate-hosts";
  if (used_hosts(composition).size() < 2)
    throw ConfigError({option, 0, 0}, composition.name +
                                          " has no containers on two hosts; name hosts under domain.hosts, "
                                          "and the host of each container");
  // Names and IPv6 addresses mean nothing in a network that is made for the run.
  std::set<std::uint32_t> taken;
  for (Host& host : composition.domain.hosts) {
    if (!ipv4(host.address)) host.address.clear();
    if (host.interface == "lo") host.interface.clear();
    if (const auto address = ipv4(host.address)) taken.insert(*address);
  }
  const std::uint32_t network = (taken.empty() ? kEmulatedNetwork : *taken.begin()) & kNetmask;
  if (!taken.empty() && (*taken.rbegin() & kNetmask) != network)
    throw ConfigError({option, 0, 0},
                      to_text_of(*taken.begin()) + " and " + to_text_of(*taken.rbegin()) +
                          " are not in one network; give hosts addresses that differ in the last number");
  std::uint32_t next = network;
  for (Host& host : composition.domain.hosts) {
    if (host.interface.empty()) host.interface = "emulated";
    if (!host.address.empty()) continue;
    do ++next;
    while (taken.contains(next));
    host.address = to_text_of(next);
  }
  composition.emulate_hosts = true;
}

void choose_host(Composition& composition, const std::string& name) {
  const std::vector<std::string> known = host_names(composition.domain);
  if (!name.empty() && find(composition, name) == nullptr)
    throw ConfigError({"--host " + name, 0, 0},
                      composition.name + " has no such host" + config::hint(name, known, "it has"));
  composition.host = name;

  // A container without a host: with one host there is no question, with several nobody could say who runs it.
  std::vector<std::string> used = used_hosts(composition);
  for (Container& container : composition.containers) {
    if (!container.host.empty()) continue;
    if (known.size() == 1 || (known.size() > 1 && composition.containers.size() == 1))
      container.host = known.size() == 1 ? known.front() : name;
    else if (!used.empty())
      throw ConfigError(container.location, "the container '" + container.name +
                                                "' needs a host, as others have one: " + config::joined(known));
  }
  used = used_hosts(composition);
  if (!composition.domain.multicast && used.size() > 1)
    for (const std::string& each : used)
      if (find(composition, each)->address.empty())
        throw ConfigError(find(composition, each)->location,
                          "without multicast the others find '" + each + "' only by its address; add one");
  for (const auto& [host, count] : containers_by_host(composition))
    if (count > kMostContainers)
      throw ConfigError(composition.containers.front().location,
                        std::to_string(count) + " containers are on one host" +
                            (host.empty() ? "" : " ('" + host + "')") + "; DDS has room for " +
                            std::to_string(kMostContainers) + " there, so let some of them share a container");
}

std::vector<const Container*> containers_here(const Composition& composition) {
  std::vector<const Container*> here;
  const std::vector<std::string> used = used_hosts(composition);
  if (composition.host.empty() && !composition.emulate_hosts && used.size() > 1 && !all_here(composition)) {
    const auto elsewhere = std::ranges::find_if(composition.containers, [&](const Container& container) {
      return container.host != composition.containers.front().host;
    });
    throw ConfigError(elsewhere->location,
                      "the containers are on several hosts; say which one this is, --host " + used.front() + " or " +
                          config::joined({used.begin() + 1, used.end()}) +
                          ", take all of them with --place all, or let this machine play them with "
                          "--emulate-hosts");
  }
  for (const Container& container : composition.containers)
    if (composition.host.empty() || container.host.empty() || container.host == composition.host)
      here.push_back(&container);
  if (here.empty())
    throw ConfigError(
        {"--host " + composition.host, 0, 0},
        "no container of " + composition.name + " is on this host; there are some on " + config::joined(used));
  return here;
}

HostNetwork network_of(const Composition& composition, const Container& container) {
  HostNetwork network;
  const Host* here = find(composition, container.host.empty() ? composition.host : container.host);
  if (here != nullptr && (!here->interface.empty() || !here->address.empty())) {
    network.interface = here->interface;
    if (network.interface.empty()) network.address = here->address;
  }
  for (const std::string& other : used_hosts(composition))
    if (here != nullptr && other != here->name && !find(composition, other)->address.empty())
      network.peers.push_back(find(composition, other)->address);
  using Multicast = HostNetwork::Multicast;
  if (!composition.domain.multicast)
    network.multicast = Multicast::no;
  else if (!network.peers.empty())
    network.multicast = Multicast::discovery_only;
  // Where the interface has no multicast, processes of this host find each other only if they look here too.
  if (network.multicast != Multicast::yes)
    network.peers.push_back(here != nullptr && !here->address.empty() ? here->address : "127.0.0.1");
  if (!network.peers.empty()) {
    // Each peer is asked at every port it could have, so there are no more of those than the composition needs.
    int most = 0;
    for (const auto& [host, count] : containers_by_host(composition)) most = std::max(most, count);
    network.processes = std::min(kMostProcesses, most + 16);
  }
  return network;
}

}  // namespace kervan::composition
