#include "tests/network/endpoint.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace kervan::test {
namespace {

sockaddr_in internet(const std::string& address) {
  sockaddr_in there{};
  there.sin_family = AF_INET;
  there.sin_port = htons(5000);
  if (::inet_pton(AF_INET, address.c_str(), &there.sin_addr) != 1) throw std::runtime_error(address + ": no address");
  return there;
}

}  // namespace

Endpoint::Endpoint(const link::NetworkNamespace& space, const std::string& address) {
  space.inside([this] { socket_ = link::Descriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)); });
  const sockaddr_in own = internet(address);
  if (::bind(socket_.number(), reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0)
    throw std::runtime_error(address + ": " + std::strerror(errno));
}

void Endpoint::send(const Packet& packet, std::size_t size, const std::string& to) const {
  std::array<std::byte, 1472> payload{};
  std::memcpy(payload.data(), &packet, sizeof packet);
  const sockaddr_in there = internet(to);
  // What the host itself does not take is lost, as on the way.
  static_cast<void>(
      ::sendto(socket_.number(), payload.data(), size, 0, reinterpret_cast<const sockaddr*>(&there), sizeof there));
}

std::optional<Packet> Endpoint::receive(std::chrono::nanoseconds patience) const {
  pollfd watched{socket_.number(), POLLIN, 0};
  const timespec timeout{patience.count() / 1'000'000'000, patience.count() % 1'000'000'000};
  Packet packet;
  if (::ppoll(&watched, 1, &timeout, nullptr) != 1 ||
      ::recv(socket_.number(), &packet, sizeof packet, MSG_DONTWAIT) < static_cast<ssize_t>(sizeof packet))
    return std::nullopt;
  return packet;
}

}  // namespace kervan::test
