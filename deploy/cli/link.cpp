// kervan link: two network namespaces joined by an emulated link, until somebody ends it.
#include <fcntl.h>
#include <sys/poll.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <iostream>
#include <nlohmann/json.hpp>

#include "deploy/cli/print_json.hpp"
#include "deploy/cli/table.hpp"
#include "deploy/cli/verbs.hpp"
#include "deploy/composition/hosts.hpp"
#include "deploy/composition/links.hpp"
#include "deploy/lab/link/ethernet_switch.hpp"
#include "deploy/lab/link/netem.hpp"

namespace kervan::cli {
namespace {

using composition::LinkSettings;
using config::Node;

volatile std::sig_atomic_t signal_seen = 0;
int quit_pipe = -1;

extern "C" void quit(int signal) {
  signal_seen = signal;
  const char word = 'q';
  if (::write(quit_pipe, &word, 1) != 1) return;  // it is full of the same word
}

std::string option_of(std::string name) {
  for (char& c : name)
    if (c == '_') c = '-';
  return "--" + name;
}

/// The options as the map that a composition would have.
LinkSettings settings_of(const LinkRequest& request) {
  Node node;
  node.kind = config::Kind::map;
  node.location = node.key_location = {"kervan link", 0, 0};
  for (const auto& [name, text] : request.settings)
    node.children.push_back(config::scalar(text, name, option_of(name) + " " + text));
  if (!request.down.empty()) {
    Node down;
    down.kind = config::Kind::list;
    down.name = "down";
    down.location = down.key_location = {"--down", 0, 0};
    for (const std::string& span : request.down) down.children.push_back(config::scalar(span, "", "--down " + span));
    node.children.push_back(std::move(down));
  }
  const LinkSettings base =
      request.profile.empty()
          ? LinkSettings{}
          : composition::link_profile(config::scalar(request.profile, "", "--profile " + request.profile));
  return composition::read_link_settings(node, base);
}

std::uint32_t address_of(const std::string& option, const std::string& text) {
  const auto address = composition::ipv4(text);
  if (!address) throw ConfigError({option + " " + text, 0, 0}, "this is no IPv4 address; write e.g. 10.77.0.1");
  return *address;
}

void require_addresses(const LinkRequest& request) {
  const std::uint32_t a = address_of("--address-a", request.address_a),
                      b = address_of("--address-b", request.address_b);
  const Location at{"--address-b " + request.address_b, 0, 0};
  if (a == b) throw ConfigError(at, "this is the address of the other end, too");
  if ((a ^ b) >> 8 != 0)
    throw ConfigError(at, "not in one network with " + request.address_a + "; let them differ in the last number");
}

std::uint64_t seed_of(const LinkRequest& request) {
  const std::int64_t seed = config::scalar(request.seed, "", "--seed " + request.seed).as_integer();
  if (seed < 0) throw ConfigError({"--seed " + request.seed, 0, 0}, "out of range; allowed: at least 0");
  return static_cast<std::uint64_t>(seed);
}

Duration limit_of(const LinkRequest& request) {
  if (request.time_limit.empty()) return forever;
  const std::string option = "--for " + request.time_limit;
  const Duration limit = config::scalar(request.time_limit, "", option).as_duration();
  if (limit <= Duration::zero()) throw ConfigError({option, 0, 0}, "the time must be longer than 0 s");
  return limit;
}

void say_ready(const LinkRequest& request) {
  std::cerr << request.a << " (" << request.address_a << ") and " << request.b << " (" << request.address_b
            << ") are joined by " << request.interface << std::endl;
}

/// What is said of A and B, with the names that they were given.
std::vector<link::LinkReport> named(std::vector<link::LinkReport> reports, const LinkRequest& request) {
  for (link::LinkReport& report : reports) {
    report.from = report.from == "A" ? request.a : request.b;
    report.to = report.to == "A" ? request.a : request.b;
  }
  return reports;
}

std::vector<link::LinkReport> emulate(const LinkRequest& request, const LinkSettings& settings, int control,
                                      Duration limit) {
  const auto a = link::NetworkNamespace::open(request.a), b = link::NetworkNamespace::open(request.b);
  // The names are part of the seed, and that of a process would be another one every time.
  std::vector<link::SwitchPort> ports;
  ports.push_back({"A", a.make_tap({request.interface, link::mac_of_port(0), request.address_a, 24})});
  ports.push_back({"B", b.make_tap({request.interface, link::mac_of_port(1), request.address_b, 24})});
  link::EthernetSwitch network(std::move(ports), {seed_of(request), settings, {}});
  say_ready(request);
  network.begin();
  network.run(control, limit);
  return named(network.reports(), request);
}

std::vector<link::LinkReport> use_netem(const LinkRequest& request, const LinkSettings& settings, int control,
                                        Duration limit) {
  const auto a = link::NetworkNamespace::open(request.a), b = link::NetworkNamespace::open(request.b);
  const link::NetemLink cable({&a, {request.interface, {}, request.address_a, 24}, settings},
                              {&b, {request.interface, {}, request.address_b, 24}, settings});
  say_ready(request);
  pollfd watched{control, POLLIN, 0};
  const auto wait = limit == forever ? -1 : std::chrono::ceil<std::chrono::milliseconds>(limit).count();
  ::poll(&watched, 1, static_cast<int>(wait));
  const auto counters = cable.counters();
  std::vector<link::LinkReport> reports(2);
  reports[0].from = reports[1].to = "A";
  reports[0].to = reports[1].from = "B";
  for (std::size_t i = 0; i < 2; ++i) reports[i].counters = counters[i];
  return named(std::move(reports), request);
}

}  // namespace

int link(const LinkRequest& request) {
  const LinkSettings settings = settings_of(request);
  const Duration limit = limit_of(request);
  seed_of(request);
  require_addresses(request);
  if (request.interface.size() > 15)
    throw ConfigError({"--interface " + request.interface, 0, 0}, "longer than the 15 letters that a name may have");
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC | O_NONBLOCK) != 0) throw std::runtime_error("no pipe");
  quit_pipe = pipe[1];
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, quit);
  const auto reports =
      request.netem ? use_netem(request, settings, pipe[0], limit) : emulate(request, settings, pipe[0], limit);
  print_table(request.json ? std::cerr : std::cout, link::rows_of(reports));
  if (request.json) {
    nlohmann::ordered_json object = {{"result", "good"}, {"links", nlohmann::ordered_json::array()}};
    for (const link::LinkReport& report : reports) object["links"].push_back(to_json(report));
    print_json(object);
  }
  return signal_seen == 0 ? exit_good : signal_seen == SIGINT ? exit_interrupt : exit_terminated;
}

}  // namespace kervan::cli
