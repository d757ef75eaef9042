#include "deploy/lab/link/emulated_network.hpp"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <system_error>

namespace kervan::link {
namespace {

void write_all(int descriptor, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    // Who died before it was told is not to take us along.
    const ssize_t size = ::send(descriptor, text.data() + at, text.size() - at, MSG_NOSIGNAL);
    if (size > 0)
      at += static_cast<std::size_t>(size);
    else if (errno != EINTR)
      return;
  }
}

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 4096> part{};
  for (;;) {
    const ssize_t size = ::read(descriptor, part.data(), part.size());
    if (size > 0)
      text.append(part.data(), static_cast<std::size_t>(size));
    else if (size == 0 || errno != EINTR)
      return text;
  }
}

}  // namespace

EmulatedNetwork::EmulatedNetwork(const std::vector<EmulatedHost>& hosts, const composition::Links& links) {
  std::vector<SwitchPort> ports;
  for (const EmulatedHost& host : hosts) {
    hosts_.push_back({host.name, NetworkNamespace::make()});
    ports.push_back(
        {host.name, hosts_.back().space.make_tap({host.interface, mac_of_port(ports.size()), host.address, 24})});
  }
  EthernetSwitch network(std::move(ports), links);
  std::array<int, 2> line{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, line.data()) != 0)
    throw std::system_error(errno, std::generic_category(), "no line to the emulated network");
  line_ = Descriptor(line[0]);
  Descriptor far_end(line[1]);
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ < 0) throw std::system_error(errno, std::generic_category(), "the emulated network cannot be started");
  if (pid_ == 0) {
    line_.close();
    serve(network, far_end.number(), parent);
  }
}

/// The rest of the child's life.
void EmulatedNetwork::serve(EthernetSwitch& network, int line, pid_t parent) {
  // Ctrl-C is for the containers; the network is there as long as they are.
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::prctl(PR_SET_NAME, "kervan-network");
  if (::getppid() != parent) ::_exit(1);
  hosts_.clear();
  try {
    network.run(line);
    nlohmann::ordered_json reports = nlohmann::ordered_json::array();
    for (const LinkReport& one : network.reports()) reports.push_back(to_json(one));
    write_all(line, reports.dump());
  } catch (const std::exception&) {
    ::_exit(1);
  }
  ::_exit(0);  // what stands in the parent's buffers is for the parent to write
}

EmulatedNetwork::~EmulatedNetwork() {
  if (reaped_) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

int EmulatedNetwork::namespace_of(const std::string& host) const {
  for (const Host& one : hosts_)
    if (one.name == host) return one.space.descriptor();
  return -1;
}

void EmulatedNetwork::begin() { write_all(line_.number(), "b"); }

std::string EmulatedNetwork::trouble() {
  int status = 0;
  if (!reaped_ && ::waitpid(pid_, &status, WNOHANG) == pid_) reaped_ = true;
  return reaped_ ? "the emulated network died" : "";
}

std::vector<LinkReport> EmulatedNetwork::end() {
  ::shutdown(line_.number(), SHUT_WR);
  const auto written = nlohmann::ordered_json::parse(read_all(line_.number()), nullptr, false);
  if (!reaped_) ::waitpid(pid_, nullptr, 0);
  reaped_ = true;
  std::vector<LinkReport> reports;
  if (written.is_array())
    for (const auto& one : written) reports.push_back(link_report_of(one));
  return reports;
}

}  // namespace kervan::link
