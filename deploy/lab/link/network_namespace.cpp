#include "deploy/lab/link/network_namespace.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace kervan::link {
namespace {

constexpr const char* kOwn = "/proc/thread-self/ns/net";

[[noreturn]] void refuse(const std::string& what) {
  if (errno == EPERM || errno == EACCES)
    throw NoPermission(what + ": " + std::strerror(errno) +
                       "; network namespaces and their interfaces need root, or CAP_SYS_ADMIN and CAP_NET_ADMIN");
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

Descriptor open_namespace(const std::string& path) {
  Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor.number() < 0) refuse("the network namespace " + path + " cannot be opened");
  return descriptor;
}

/// Takes the thread back home, whatever happens.
class Return {
 public:
  explicit Return(Descriptor home) : home_(std::move(home)) {}
  ~Return() {
    // Whoever goes on in another network than it believes would do harm there.
    if (::setns(home_.number(), CLONE_NEWNET) != 0) std::terminate();
  }
  Return(const Return&) = delete;
  Return& operator=(const Return&) = delete;

 private:
  Descriptor home_;
};

ifreq request_for(const std::string& name) {
  ifreq request{};
  std::copy_n(name.data(), std::min<std::size_t>(name.size(), IFNAMSIZ - 1), request.ifr_name);
  return request;
}

sockaddr ipv4(in_addr_t address) {
  sockaddr_in internet{};
  internet.sin_family = AF_INET;
  internet.sin_addr.s_addr = address;
  sockaddr plain{};
  static_assert(sizeof plain == sizeof internet);
  std::memcpy(&plain, &internet, sizeof plain);
  return plain;
}

/// Settings of the interfaces of the namespace where this thread is.
class Interfaces {
 public:
  Interfaces() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    if (socket_.number() < 0) refuse("no socket");
  }

  void set(unsigned long what, ifreq request, const char* words) const {
    if (::ioctl(socket_.number(), what, &request) != 0)
      refuse("the interface " + std::string(request.ifr_name) + " cannot be given " + words);
  }

  void set_up(const std::string& name) const {
    ifreq request = request_for(name);
    request.ifr_flags = IFF_UP | IFF_RUNNING | IFF_MULTICAST;
    set(SIOCSIFFLAGS, request, "its state");
  }

 private:
  Descriptor socket_;
};

}  // namespace

NetworkNamespace NetworkNamespace::make() {
  Descriptor home = open_namespace(kOwn);
  if (::unshare(CLONE_NEWNET) != 0) refuse("no network namespace can be made");
  const Return back(std::move(home));
  // No router solicitations and no multicast reports of IPv6: all that passes is then what the hosts say. Where /proc
  // cannot be written, they are a few packets more.
  std::ofstream("/proc/sys/net/ipv6/conf/default/disable_ipv6") << 1;
  Interfaces().set_up("lo");
  return NetworkNamespace(open_namespace(kOwn));
}

NetworkNamespace NetworkNamespace::open(const std::string& name) {
  if (name.find('/') != std::string::npos) return NetworkNamespace(open_namespace(name));
  if (std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; }))
    return NetworkNamespace(open_namespace("/proc/" + name + "/ns/net"));
  return NetworkNamespace(open_namespace("/run/netns/" + name));
}

void NetworkNamespace::inside(const std::function<void()>& what) const {
  Descriptor home = open_namespace(kOwn);
  if (::setns(descriptor(), CLONE_NEWNET) != 0) refuse("the network namespace cannot be entered");
  const Return back(std::move(home));
  what();
}

Descriptor NetworkNamespace::make_tap(const InterfacePlan& plan) const {
  Descriptor tap;
  inside([&] {
    tap = Descriptor(::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC));
    if (tap.number() < 0) refuse("/dev/net/tun cannot be opened");
    ifreq request = request_for(plan.name);
    request.ifr_flags = IFF_TAP | IFF_NO_PI;
    if (::ioctl(tap.number(), TUNSETIFF, &request) != 0) refuse("the interface " + plan.name + " cannot be made");
    const Interfaces interfaces;
    request = request_for(plan.name);
    request.ifr_hwaddr.sa_family = ARPHRD_ETHER;
    std::copy(plan.mac.begin(), plan.mac.end(), request.ifr_hwaddr.sa_data);
    interfaces.set(SIOCSIFHWADDR, request, "its hardware address");
    in_addr address{};
    if (::inet_pton(AF_INET, plan.address.c_str(), &address) != 1)
      throw std::runtime_error(plan.address + " is not an IPv4 address");
    request = request_for(plan.name);
    request.ifr_addr = ipv4(address.s_addr);
    interfaces.set(SIOCSIFADDR, request, "an address");
    request.ifr_netmask = ipv4(htonl(plan.prefix == 0 ? 0 : ~std::uint32_t{0} << (32 - plan.prefix)));
    interfaces.set(SIOCSIFNETMASK, request, "a netmask");
    interfaces.set_up(plan.name);
  });
  return tap;
}

}  // namespace kervan::link
