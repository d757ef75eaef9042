/// The hosts of a composition and how their processes find each other.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "deploy/composition/composition.hpp"

namespace kervan::composition {

/// `domain:` as written.
Domain read_domain(const config::Node& node);

/// An address that stands as four numbers, in the machine's byte order; nothing if it is none.
std::optional<std::uint32_t> ipv4(const std::string& text);

/// In the file's order.
std::vector<std::string> host_names(const Domain& domain);

/// For hosts that this machine plays: each gets an IPv4 address in one network, its own if it has one, and a network
/// interface of its own. To be called before choose_host(). Throws ConfigError if there are no containers on two hosts.
void emulate_hosts(Composition& composition);

/// Sets the host that `--host` names (empty: none was named) and checks that what the composition says of hosts can
/// work. Throws ConfigError for a host that is not in the file, and for containers whose place nobody knows.
void choose_host(Composition& composition, const std::string& name);

/// The containers that this host runs, in the file's order. Throws ConfigError if they are on several hosts and nobody
/// said which one this is.
std::vector<const Container*> containers_here(const Composition& composition);

/// How the process of a container finds the others.
struct HostNetwork {
  std::string interface = "lo";         ///< its name; empty if the address says which
  std::string address = {};             ///< of the interface
  std::vector<std::string> peers = {};  ///< addresses to look for, beside what multicast finds
  enum class Multicast {
    yes,
    discovery_only,  ///< to find each other, not for samples: wireless networks lose those
    no,
  } multicast = Multicast::yes;
  int processes = 120;  ///< that can take part on one host; 120 is the most that the ports of DDS have room for
};
HostNetwork network_of(const Composition& composition, const Container& container);

}  // namespace kervan::composition
