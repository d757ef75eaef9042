/// The same link by the kernel: a veth cable between two namespaces, with netem (tc-netem(8)) at both ends. Not every
/// kernel has netem, its drops follow no seed, and it knows no schedule.
#pragma once

#include <string>
#include <vector>

#include "deploy/lab/link/counters_json.hpp"
#include "deploy/lab/link/network_namespace.hpp"

namespace kervan::link {

/// What follows `tc qdisc add dev X root netem`. Throws ConfigError for what netem cannot do.
std::vector<std::string> netem_arguments(const composition::LinkSettings& settings);

/// The counters out of `tc -s -j qdisc show dev X`; netem does not say why it dropped a packet, so all it dropped are
/// `lost`. Throws std::runtime_error if there is no netem in it.
LinkCounters netem_counters(const std::string& text);

struct NetemEnd {
  const NetworkNamespace* space;
  InterfacePlan interface;
  composition::LinkSettings to_the_other;
};

/// The cable. It stays if this process is killed, until one of its namespaces goes.
class NetemLink {
 public:
  /// Throws NoPermission, or std::runtime_error with what ip or tc says.
  NetemLink(NetemEnd a, NetemEnd b);
  ~NetemLink();
  NetemLink(const NetemLink&) = delete;
  NetemLink& operator=(const NetemLink&) = delete;

  /// From a to b, and from b to a.
  std::vector<LinkCounters> counters() const;

 private:
  NetemEnd a_, b_;
};

}  // namespace kervan::link
