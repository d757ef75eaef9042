/// A composition split over processes, beside the same processes in raw C, in one run: one hop between two processes,
/// and the CPU of a chain over ten.
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "bench_msgs/msg/Payload.hpp"
#include "framework/kervan.hpp"
#include "framework/runtime/container.hpp"
#include "framework/test/harness.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/split_reference.hpp"
#include "tests/bench/statistics.hpp"

extern char** environ;

namespace {

using namespace kervan;
using namespace std::chrono_literals;
using bench::median;
using bench::now_ns;
using bench::say;
using bench_msgs::msg::Payload;

runtime::ContainerSpec container_spec(const std::string& tag) {
  runtime::ContainerSpec spec;
  spec.domain = {.id = 225, .network = true, .interface = "lo", .tag = tag};
  spec.log_to_console = spec.publish_log = false;
  return spec;
}

std::string topic(int place) { return "/chain" + std::to_string(place + 1); }

/// One process of the chain, as raw_c_link().
[[noreturn]] void kervan_link(const std::string& tag, int place, bool last) {
  ComponentRegistry registry(ComponentRegistry::default_folders());
  runtime::ContainerSpec spec = container_spec(tag);
  const QosProfile profile = *builtin_profile("state");
  spec.components.push_back({.name = "relay" + std::to_string(place),
                             .type = "bench/relay",
                             .parameters = {{"first", place == 0}, {"period", 0.001}},
                             .ports = {{"in", topic(place - 1), profile}, {"out", topic(place), profile}}});
  runtime::Container container(spec, registry);
  const runtime::ComponentInstance& relay = *container.instances().front();
  while ((!last && relay.outputs().front()->writer().status().matched == 0) ||
         (place > 0 && relay.inputs().front()->reader().status().matched == 0))
    std::this_thread::sleep_for(1ms);
  std::puts("matched");
  std::fflush(stdout);
  container.run({});
  std::exit(1);  // a chain runs until it is ended from outside
}

struct HopRun {
  std::size_t count = 0;
  std::vector<std::int64_t> hops;
} hop_run;

class Listener final : public Component {
  Input<Payload> in_{this, "in", qos::state, &Listener::on_message, "Messages of another process."};

  void on_message(const Payload& message, Time) {
    hop_run.hops.push_back(now_ns() - message.stamp);
    if (hop_run.hops.size() >= hop_run.count) finish("enough");
  }
};
const ComponentClass listener = test::define<Listener>("bench/listener");

std::vector<std::int64_t> kervan_split_hops(const std::string& tag, std::size_t count) {
  ComponentRegistry registry({});
  registry.add(listener);
  hop_run = {count, {}};
  hop_run.hops.reserve(count);
  runtime::ContainerSpec spec = container_spec(tag);
  spec.components.push_back(
      {.name = "listener", .type = listener.type, .ports = {{"in", topic(0), *builtin_profile("state")}}});
  runtime::Container(spec, registry).run({});
  return std::move(hop_run.hops);
}

/// A process of a chain: this program again, in another role.
class Link {
 public:
  Link(const char* role, const std::string& tag, int place, bool last) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) std::exit(1);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    const std::string number = std::to_string(place);
    const char* arguments[] = {"/proc/self/exe", role, tag.c_str(), number.c_str(), last ? "last" : "", nullptr};
    if (posix_spawn(&pid_, arguments[0], &actions, nullptr, const_cast<char* const*>(arguments), environ) != 0)
      std::exit(1);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    output_ = fdopen(ends[0], "r");
  }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;
  ~Link() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    std::fclose(output_);
  }

  void wait_until_matched() {
    char line[16];
    if (std::fgets(line, sizeof line, output_)) return;
    std::fprintf(stderr, "a process of the chain ended at once\n");
    std::exit(1);
  }

  double cpu_seconds() const {
    clockid_t clock = 0;
    timespec time{};
    if (clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &time) != 0) std::exit(1);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
  }

 private:
  pid_t pid_ = 0;
  FILE* output_ = nullptr;
};

std::string new_tag() {
  static int number = 0;
  return "split-" + std::to_string(getpid()) + "-" + std::to_string(++number);
}

using Hops = std::vector<std::int64_t> (*)(const std::string& tag, std::size_t count);

double hop_us(const char* role, Hops hops, std::size_t count) {
  const std::string tag = new_tag();
  const Link sender(role, tag, 0, false);
  return static_cast<double>(median(hops(tag, count))) * 1e-3;
}

/// Percent of one core that all processes of a chain use together while it runs.
double chain_cpu(const char* role, int length, double duration) {
  const std::string tag = new_tag();
  std::vector<std::unique_ptr<Link>> links;
  for (int place = 0; place < length; ++place)
    links.push_back(std::make_unique<Link>(role, tag, place, place + 1 == length));
  for (const auto& link : links) link->wait_until_matched();
  std::this_thread::sleep_for(300ms);  // discovery goes on a little after the chain is matched
  const auto total = [&] {
    double sum = 0.0;
    for (const auto& link : links) sum += link->cpu_seconds();
    return sum;
  };
  const double before = total();
  const std::int64_t begin = now_ns();
  std::this_thread::sleep_for(std::chrono::duration<double>(duration));
  return (total() - before) / (static_cast<double>(now_ns() - begin) * 1e-9) * 100.0;
}

void bench_hop(int rounds, std::size_t count) {
  std::vector<double> ours, theirs, ratios;
  for (int round = 0; round < rounds; ++round) {
    ours.push_back(hop_us("--kervan-link", kervan_split_hops, count));
    theirs.push_back(hop_us("--raw-link", bench::raw_c_split_hops, count));
    ratios.push_back(ours.back() / theirs.back());
  }
  say("\n## One hop between two processes, 64 B at 1 kHz, p50 of %d alternating rounds\n\n", rounds);
  say("| Kervan us | raw C, waitset us | ratio | target |\n|---|---|---|---|\n");
  say("| %.1f | %.1f | %.2f | 1.1 |\n", median(ours), median(theirs), median(ratios));
}

void bench_chain(int rounds, double duration) {
  constexpr int length = 10;
  std::vector<double> ours, theirs, ratios;
  for (int round = 0; round < rounds; ++round) {
    ours.push_back(chain_cpu("--kervan-link", length, duration));
    theirs.push_back(chain_cpu("--raw-link", length, duration));
    ratios.push_back(ours.back() / theirs.back());
  }
  say("\n## A chain of ten components in ten processes at 1 kHz, CPU of one core, median of %d alternating rounds\n\n",
      rounds);
  say("| Kervan %% | raw C, waitsets %% | ratio | target |\n|---|---|---|---|\n");
  say("| %.1f | %.1f | %.2f | 1.3 |\n", median(ours), median(theirs), median(ratios));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 5) {
    const std::string role = argv[1];
    const int place = std::atoi(argv[3]);
    const bool last = std::strcmp(argv[4], "last") == 0;
    if (role == "--kervan-link") kervan_link(argv[2], place, last);
    if (role == "--raw-link") bench::raw_c_link(argv[2], place, last);
  }
  const bool smoke = bench::begin(argc, argv, "Split over processes");
  bench_hop(smoke ? 1 : 9, smoke ? 100 : 2000);
  bench_chain(smoke ? 1 : 5, smoke ? 0.2 : 3.0);
  return bench::end();
}
