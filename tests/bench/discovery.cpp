/// How long containers need to find each other, and one to start: from the start of the processes to the moment when
/// the last of them is active. Each container is a process of its own, this program with other arguments.
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "builtin_interfaces/msg/Time.hpp"
#include "framework/kervan.hpp"
#include "framework/runtime/container.hpp"
#include "framework/test/harness.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/statistics.hpp"
#include "tests/conformance/wire/peer.hpp"

namespace {

using namespace kervan;
using bench::now_ns;
using builtin_interfaces::msg::Time;

/// One link of a ring: hears the one before, is heard by the next.
class Link final : public Component {
  Input<Time> in_{this, "in", qos::event, "From the link before."};
  Output<Time> out_{this, "out", qos::event, "To the next link."};
};

struct Shape {
  unsigned containers;
  unsigned components;  ///< of each container
};

/// The ring of all components, in the order of the containers.
runtime::ContainerSpec spec_of(const Shape& shape, unsigned container, const std::string& tag, std::uint32_t domain) {
  runtime::ContainerSpec spec;
  spec.name = "c" + std::to_string(container);
  spec.domain.id = domain;
  spec.domain.tag = tag;
  spec.log_to_console = false;
  const unsigned links = shape.containers * shape.components;
  const TypeSupport& type = type_support<Time>();
  const QosProfile event = *builtin_profile("event");
  for (unsigned c = 0; c < shape.containers; ++c) spec.members.push_back("c" + std::to_string(c));
  for (unsigned link = 0; link < links; ++link) {
    const auto topic = [&](unsigned of) { return "/link" + std::to_string(of % links); };
    spec.components.push_back(
        {.name = "link" + std::to_string(link),
         .type = "bench/link",
         .container = "c" + std::to_string(link / shape.components),
         .ports = {{"in", topic(link + links - 1), event, PortDirection::input, type.name, type.layout_hash},
                   {"out", topic(link), event, PortDirection::output, type.name, type.layout_hash}}});
  }
  return spec;
}

std::atomic<bool> stop{false};

int run_container(const Shape& shape, unsigned container, const std::string& tag, std::uint32_t domain) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  ComponentRegistry registry({});
  registry.add(test::define<Link>("bench/link"));
  runtime::Container running(spec_of(shape, container, tag, domain), registry);
  runtime::RunControl control;
  control.stop = &stop;
  control.phase = [](runtime::RunPhase phase) {
    if (phase == runtime::RunPhase::matched) std::printf("matched %lld\n", static_cast<long long>(now_ns()));
    if (phase == runtime::RunPhase::active) std::printf("active %lld\n", static_cast<long long>(now_ns()));
    std::fflush(stdout);
  };
  control.progress = [](kervan::Time) {
    char byte;
    if (read(STDIN_FILENO, &byte, 1) == 0) stop = true;  // the benchmark is done with this process, or died
  };
  running.run(control);
  return 0;
}

/// Seconds from the start of the first process until the last one said `word`.
double time_until(const char* word, std::int64_t start, std::vector<std::unique_ptr<test::Peer>>& peers) {
  std::int64_t last = start;
  for (const auto& peer : peers) {
    if (!test::eventually([&] { return peer->lines_that_begin_with(word) > 0; }))
      throw std::runtime_error(std::string("a container is never ") + word);
    for (const std::string& line : peer->lines())
      if (line.starts_with(word)) last = std::max<std::int64_t>(last, std::stoll(line.substr(std::strlen(word))));
  }
  return static_cast<double>(last - start) * 1e-9;
}

struct Result {
  double matched;
  double active;
};

Result measure(const Shape& shape, int round) {
  const std::string tag = "discovery-" + std::to_string(getpid()) + "-" + std::to_string(round);
  const std::string domain = std::to_string(20 + getpid() % 200);
  const std::int64_t start = now_ns();
  std::vector<std::unique_ptr<test::Peer>> peers;
  for (unsigned c = 0; c < shape.containers; ++c)
    peers.push_back(std::make_unique<test::Peer>(
        std::vector<std::string>{"--container", std::to_string(c), std::to_string(shape.containers),
                                 std::to_string(shape.components), tag, domain}));
  Result result{};
  result.matched = time_until("matched", start, peers);
  result.active = time_until("active", start, peers);
  for (const auto& peer : peers) peer->end();
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const auto number = [&](std::size_t at) { return static_cast<unsigned>(std::stoul(arguments[at])); };
  if (arguments.size() == 6 && arguments[0] == "--container")
    return run_container({number(2), number(3)}, number(1), arguments[4], number(5));

  const bool smoke = bench::begin(argc, argv, "Discovery");
  bench::say("\n## From the start of the processes to the moment when the last container is there, in ms\n\n");
  bench::say(
      "| containers | components of each | matched, median / most | active, median / most |\n|---|---|---|---|\n");
  const std::vector<Shape> shapes =
      smoke ? std::vector<Shape>{{3, 2}} : std::vector<Shape>{{1, 10}, {2, 1}, {20, 1}, {20, 5}};
  int round = 0;
  for (const Shape& shape : shapes) {
    std::vector<double> matched, active;
    for (int i = 0; i < (smoke ? 1 : 11); ++i) {
      const Result result = measure(shape, ++round);
      matched.push_back(result.matched * 1e3);
      active.push_back(result.active * 1e3);
    }
    bench::say("| %u | %u | %.0f / %.0f | %.0f / %.0f |\n", shape.containers, shape.components, bench::median(matched),
               std::ranges::max(matched), bench::median(active), std::ranges::max(active));
  }
  return bench::end();
}
