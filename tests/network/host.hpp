/// A host for tests: a network namespace of its own. It has no name anywhere and goes away with this object, or with
/// the test, whatever becomes of that; and with it its interfaces.
#pragma once

#include <sys/types.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "tests/program/program.hpp"

namespace kervan::test {

/// Namespaces or interfaces cannot be made here: the test is not root, or the system has no iproute2 or no veth.
class NoHosts : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Host {
 public:
  /// With nothing but a loopback interface, which is up. Throws NoHosts.
  Host();
  ~Host();
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  /// Calls ip(8) there. Throws NoHosts with what it says, unless it succeeds.
  void ip(const std::string& arguments) const;

  /// Lays a cable to `other`: an interface called `name` on both sides, with these addresses and without multicast.
  void connect(Host& other, const std::string& name, const std::string& address, const std::string& address_there);

  /// Where the kernel shows its namespace.
  std::string network() const { return "/proc/" + std::to_string(holder_) + "/ns/net"; }

  /// The command, to be started there.
  Command command(const Command& command) const;

 private:
  pid_t holder_ = -1;  ///< a process that does nothing but hold the namespace
};

}  // namespace kervan::test
