/// A UDP socket in a network namespace. The process that holds it stays where it is.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "deploy/lab/link/network_namespace.hpp"

namespace kervan::test {

/// A packet of `size` bytes of payload; a number and a time are all that is in it.
struct Packet {
  std::uint32_t number = 0;
  std::int64_t sent_ns = 0;  ///< of the steady clock
};

class Endpoint {
 public:
  /// What comes before a packet's payload on the wire: the headers of UDP, IPv4 and Ethernet.
  static constexpr std::size_t kHeaders = 8 + 20 + 14;

  /// `address` is one of the namespace's. Throws std::runtime_error.
  Endpoint(const link::NetworkNamespace& space, const std::string& address);

  /// `size` from sizeof(Packet) to 1472 bytes.
  void send(const Packet& packet, std::size_t size, const std::string& to) const;

  /// The next packet; nothing if none comes in this time.
  std::optional<Packet> receive(std::chrono::nanoseconds patience) const;

 private:
  link::Descriptor socket_;
};

}  // namespace kervan::test
