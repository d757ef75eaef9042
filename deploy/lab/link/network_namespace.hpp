/// A network stack of its own, and the ends of emulated links in it. Nothing here has a name in the file system: a
/// namespace lives as long as somebody holds its descriptor or a process is in it, an interface as long as somebody
/// holds its descriptor.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>

#include "deploy/lab/link/descriptor.hpp"

namespace kervan::link {

/// The system does not let us make namespaces or interfaces; one line says what is missing.
class NoPermission : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

using MacAddress = std::array<std::uint8_t, 6>;

struct InterfacePlan {
  std::string name;     ///< at most 15 characters
  MacAddress mac = {};  ///< of the namespace's side
  std::string address;  ///< IPv4, "10.77.0.1"
  int prefix = 24;      ///< how many of its bits are the network's
};

class NetworkNamespace {
 public:
  /// A new one, with nothing but a loopback interface, which is up. Throws NoPermission.
  static NetworkNamespace make();
  /// The one that `name` names: a number, of a process that is in it; a path, such as /proc/1234/ns/net; or a name that
  /// `ip netns` knows. Throws std::runtime_error if there is none.
  static NetworkNamespace open(const std::string& name);

  int descriptor() const { return descriptor_.number(); }

  /// Calls `what` with this thread in the namespace, and goes back. Throws NoPermission, and what `what` throws.
  void inside(const std::function<void()>& what) const;

  /// Makes a TAP interface, up and with this address, and returns the end that its packets come out of: Ethernet
  /// frames, read and written without waiting. Throws NoPermission or std::runtime_error.
  Descriptor make_tap(const InterfacePlan& plan) const;

 private:
  explicit NetworkNamespace(Descriptor descriptor) : descriptor_(std::move(descriptor)) {}

  Descriptor descriptor_;
};

}  // namespace kervan::link
