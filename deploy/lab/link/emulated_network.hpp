/// Hosts that are network namespaces of this machine, joined by an emulated network. A process of its own moves the
/// packets; it is gone when this one is, however that ends, and with both the namespaces and their interfaces are.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "deploy/lab/link/ethernet_switch.hpp"

namespace kervan::link {

struct EmulatedHost {
  std::string name;
  std::string interface;
  std::string address;  ///< IPv4, in one /24 network with the others
};

class EmulatedNetwork {
 public:
  /// To be made by the main thread of a process that has no other: the kernel ends the network with that thread.
  /// Throws NoPermission or std::runtime_error.
  EmulatedNetwork(const std::vector<EmulatedHost>& hosts, const composition::Links& links);
  ~EmulatedNetwork();
  EmulatedNetwork(const EmulatedNetwork&) = delete;
  EmulatedNetwork& operator=(const EmulatedNetwork&) = delete;

  /// Of a host's namespace, for processes to be put there; -1 if there is no such host.
  int namespace_of(const std::string& host) const;

  /// The run has begun: the schedule of outages does, too.
  void begin();

  /// Empty as long as the process that moves the packets lives, else one sentence.
  std::string trouble();

  /// Ends the network; what each direction did. Empty if the process died before.
  std::vector<LinkReport> end();

  pid_t pid() const { return pid_; }

 private:
  struct Host {
    std::string name;
    NetworkNamespace space;
  };
  [[noreturn]] void serve(EthernetSwitch& network, int line, pid_t parent);

  std::vector<Host> hosts_;
  Descriptor line_;  ///< to the process and back; closed on our side it ends the network
  pid_t pid_ = -1;
  bool reaped_ = false;
};

}  // namespace kervan::link
