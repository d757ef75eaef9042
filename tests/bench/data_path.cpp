/// The data path beside what it is measured against, in one run: same-thread and cross-thread hops, a chain of ten
/// components, its start and its memory. Prints ratios; asserts only what does not depend on the machine's speed.
#include <sched.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include "bench_msgs/msg/Payload.hpp"
#include "framework/component/sample.hpp"
#include "framework/dds/endpoint.hpp"
#include "framework/dds/statistics.hpp"
#include "framework/kervan.hpp"
#include "framework/runtime/container.hpp"
#include "framework/test/harness.hpp"
#include "tests/bench/reference.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/statistics.hpp"

extern char** environ;

namespace {

using namespace kervan;
using namespace std::chrono_literals;
using bench::median;
using bench::now_ns;
using bench::say;
using bench_msgs::msg::Payload;

/// What the hop components share with the measurement around them.
struct HopRun {
  std::size_t bytes = 64;
  std::size_t count = 0;
  Duration period = Duration::zero();  ///< between two messages; zero: as soon as the last has come back
  std::vector<std::int64_t> hops;
} hop_run;

/// Publishes one message a period, or the next as soon as the last has come back.
class Sender final : public Component {
  Input<Payload> back_{this, "back", qos::state, &Sender::on_back, "Answers."};
  Output<Payload> out_{this, "out", qos::state, "Messages."};
  bool paced_ = hop_run.period > Duration::zero();
  Timer tick_{this, paced_ ? hop_run.period : std::chrono::hours(1), &Sender::on_tick};
  std::uint32_t number_ = 0;

  void on_tick(Time) { send(); }
  void on_back(const Payload&, Time) {
    if (!paced_) send();
  }
  void send() {
    auto message = out_.loan_uncleared();
    message->data.resize(hop_run.bytes);
    message->number = ++number_;
    message->stamp = now_ns();
    out_.publish(std::move(message));
  }
};

class Receiver final : public Component {
  Input<Payload> in_{this, "in", qos::state, &Receiver::on_message, "Messages."};
  Output<Payload> back_{this, "back", qos::state, "Answers."};

  void on_message(const Payload& message, Time) {
    const std::int64_t received = now_ns();
    if (message.number > hop_run.count / 10) hop_run.hops.push_back(received - message.stamp);
    if (hop_run.hops.size() >= hop_run.count) return finish("enough");
    auto answer = back_.loan_uncleared();
    answer->data.clear();
    back_.publish(std::move(answer));
  }
};

class Listener final : public Component {
  Input<Payload> in_{this, "in", qos::state, &Listener::on_message, "Messages from another thread."};

  void on_message(const Payload& message, Time) {
    const std::int64_t received = now_ns();
    hop_run.hops.push_back(received - message.stamp);
    if (hop_run.hops.size() >= hop_run.count) finish("enough");
  }
};

const ComponentClass sender = test::define<Sender>("bench/sender");
const ComponentClass receiver = test::define<Receiver>("bench/receiver");
const ComponentClass listener = test::define<Listener>("bench/listener");

QosProfile state_profile(Network network = Network::sync) {
  QosProfile profile = *builtin_profile("state");
  profile.network = network;
  return profile;
}

runtime::ContainerSpec hop_spec(dds::DomainConfig domain, Network network) {
  runtime::ContainerSpec spec;
  spec.domain = std::move(domain);
  spec.log_to_console = spec.publish_log = false;
  const QosProfile profile = state_profile(network);
  spec.components.push_back(
      {.name = "sender", .type = sender.type, .ports = {{"out", "/hop", profile}, {"back", "/back", profile}}});
  spec.components.push_back(
      {.name = "receiver", .type = receiver.type, .ports = {{"in", "/hop", profile}, {"back", "/back", profile}}});
  return spec;
}

std::vector<std::int64_t> kervan_hops(std::size_t bytes, std::size_t count, const dds::DomainConfig& domain,
                                      Network network = Network::sync, Duration period = Duration::zero(),
                                      const std::function<void(runtime::Container&)>& before = {}) {
  ComponentRegistry registry({});
  registry.add(sender);
  registry.add(receiver);
  hop_run = {bytes, count, period, {}};
  hop_run.hops.reserve(count);
  runtime::Container container(hop_spec(domain, network), registry);
  if (before) before(container);
  container.run({});
  return std::move(hop_run.hops);
}

dds::DomainConfig no_network(std::uint32_t id) { return {.id = id, .network = false}; }

std::vector<std::int64_t> kervan_cross_thread_hops(std::size_t count) {
  ComponentRegistry registry({});
  registry.add(listener);
  hop_run = {64, count, Duration::zero(), {}};
  hop_run.hops.reserve(count);
  runtime::ContainerSpec spec;
  spec.domain = no_network(221);
  spec.log_to_console = spec.publish_log = false;
  spec.components.push_back({.name = "listener", .type = listener.type, .ports = {{"in", "/hop", state_profile()}}});
  runtime::Container container(spec, registry);
  dds::Writer writer(container.domain(), "/hop", type_support<Payload>(), state_profile(),
                     dds::CyclonePart::whole_profile, 0, 0);
  std::atomic<bool> done{false};
  std::thread publisher([&] {
    while (!done) {
      std::this_thread::sleep_for(1ms);
      dds::SampleBlock* block = writer.loan(false);
      auto& message = *static_cast<Payload*>(dds::mutable_value_of(block));
      message.data.resize(64);
      message.stamp = now_ns();
      writer.publish(block, Time(Duration(message.stamp)), false);
    }
  });
  container.run({});
  done = true;
  publisher.join();
  return std::move(hop_run.hops);
}

runtime::ContainerSpec chain_spec(int length, Duration period) {
  runtime::ContainerSpec spec;
  spec.domain = no_network(222);
  spec.log_to_console = spec.publish_log = false;
  for (int i = 0; i < length; ++i)
    spec.components.push_back({.name = "relay" + std::to_string(i),
                               .type = "bench/relay",
                               .parameters = {{"first", i == 0}, {"period", seconds(period)}},
                               .ports = {{"in", "/chain" + std::to_string(i - 1 + 1000), state_profile()},
                                         {"out", "/chain" + std::to_string(i + 1000), state_profile()}}});
  return spec;
}

double kervan_chain_cpu(int length, double duration) {
  ComponentRegistry registry(ComponentRegistry::default_folders());
  runtime::Container container(chain_spec(length, 1ms), registry);
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  container.run({.limit = from_seconds(duration)});
  getrusage(RUSAGE_SELF, &after);
  const auto cpu = [](const rusage& u) {
    return static_cast<double>(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
           static_cast<double>(u.ru_utime.tv_usec + u.ru_stime.tv_usec) * 1e-6;
  };
  return cpu(after) - cpu(before);
}

/// Ends the run of a chain at its first end-to-end sample and says when that was.
class ChainEnd final : public Component {
  Input<Payload> in_{this, "in", qos::state, &ChainEnd::on_message, "End of the chain."};
  void on_message(const Payload&, Time) {
    std::printf("%lld\n", static_cast<long long>(now_ns()));
    finish("arrived");
  }
};
const ComponentClass chain_end = test::define<ChainEnd>("bench/chain_end");

long resident_kib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmRSS:")) return std::atol(line.c_str() + 6);
  return 0;
}

/// What the child process does: a container of ten components, from exec to the first sample at the end.
int chain_start(int length) {
  ComponentRegistry registry(ComponentRegistry::default_folders());
  registry.add(chain_end);
  runtime::ContainerSpec spec = chain_spec(length, 1ms);
  spec.publish_log = true;
  spec.components.push_back({.name = "end",
                             .type = chain_end.type,
                             .ports = {{"in", "/chain" + std::to_string(length - 1 + 1000), state_profile()}}});
  runtime::Container container(spec, registry);
  container.run({});
  std::printf("%ld\n", resident_kib());
  return 0;
}

struct Start {
  double milliseconds;
  double mebibytes;
};

Start measure_start(const char* program) {
  int pipe_ends[2];
  if (pipe(pipe_ends) != 0) std::exit(1);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], STDOUT_FILENO);
  char* arguments[] = {const_cast<char*>(program), const_cast<char*>("--chain-start"), nullptr};
  const std::int64_t begin = now_ns();
  pid_t child = 0;
  if (posix_spawn(&child, program, &actions, nullptr, arguments, environ) != 0) std::exit(1);
  close(pipe_ends[1]);
  FILE* output = fdopen(pipe_ends[0], "r");
  long long arrived = 0;
  long resident = 0;
  const bool good = std::fscanf(output, "%lld %ld", &arrived, &resident) == 2;
  std::fclose(output);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  waitpid(child, &status, 0);
  if (!good || status != 0) {
    std::fprintf(stderr, "the container of the start benchmark failed\n");
    std::exit(1);
  }
  return {static_cast<double>(arrived - begin) * 1e-6, static_cast<double>(resident) / 1024.0};
}

/// Keeps the process, threads made later included, on one core, so that two processes do not take turns on the same.
void run_on_core(unsigned core) {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(core % std::thread::hardware_concurrency(), &cores);
  sched_setaffinity(0, sizeof cores, &cores);
}

void run_on_every_core() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  for (unsigned core = 0; core < std::thread::hardware_concurrency(); ++core) CPU_SET(core, &cores);
  sched_setaffinity(0, sizeof cores, &cores);
}

/// A reader in another process, until its standard input closes.
int remote_reader(const char* tag) {
  run_on_core(1);
  class Ignore final : public dds::SampleSink {
    void on_sample(const dds::Arrival&) noexcept override {}
    void on_writer_gone(std::uint64_t) noexcept override {}
    void on_status() noexcept override {}
  } sink;
  dds::Domain domain({.id = 223, .network = true, .interface = "lo", .tag = tag});
  const dds::Reader reader(domain, "/hop", type_support<Payload>(), state_profile(), dds::CyclonePart::whole_profile,
                           sink);
  char byte;
  while (read(STDIN_FILENO, &byte, 1) > 0) {
  }
  return 0;
}

std::vector<std::int64_t> hops_with_remote_reader(const char* program, std::size_t bytes, std::size_t count,
                                                  Network network) {
  run_on_core(0);
  const std::string tag = "bench-" + std::to_string(getpid());
  int pipe_ends[2];
  if (pipe(pipe_ends) != 0) std::exit(1);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe_ends[0], STDIN_FILENO);
  posix_spawn_file_actions_addclose(&actions, pipe_ends[1]);
  char* arguments[] = {const_cast<char*>(program), const_cast<char*>("--remote-reader"), const_cast<char*>(tag.c_str()),
                       nullptr};
  pid_t child = 0;
  if (posix_spawn(&child, program, &actions, nullptr, arguments, environ) != 0) std::exit(1);
  close(pipe_ends[0]);
  const auto wait_for_reader = [](runtime::Container& container) {
    const auto& output = *container.find("sender")->outputs().front();
    while (output.writer().status().matched < 2) std::this_thread::sleep_for(1ms);
  };
  // Paced, as real publishers are: sending back to back would measure how fast the network drains.
  auto hops = kervan_hops(bytes, count, {.id = 223, .network = true, .interface = "lo", .tag = tag}, network,
                          bytes > 100000 ? 10ms : Duration(400us), wait_for_reader);
  close(pipe_ends[1]);
  waitpid(child, nullptr, 0);
  posix_spawn_file_actions_destroy(&actions);
  run_on_every_core();
  return hops;
}

bool failed = false;

void expect_nothing_copied(const dds::DataPathStatistics& before) {
  const auto after = dds::data_path_statistics();
  if (after.serialised == before.serialised && after.deserialised == before.deserialised) return;
  say("FAILED: %llu samples were serialised although no remote reader is matched\n",
      static_cast<unsigned long long>(after.serialised - before.serialised));
  failed = true;
}

void bench_same_thread(int rounds) {
  say("\n## One hop in one thread, p50, from before publish to the first line of the handler\n\n");
  say("| size | Kervan ns | raw C listener ns | ratio | target |\n|---|---|---|---|---|\n");
  for (const std::size_t bytes : {std::size_t{64}, std::size_t{16} << 10, std::size_t{1} << 20}) {
    const std::size_t count = bytes > 100000 ? 2000 : 50000;
    std::vector<std::int64_t> ours, theirs;
    std::vector<double> ratios;
    const auto before = dds::data_path_statistics();
    for (int round = 0; round < rounds; ++round) {
      ours.push_back(median(kervan_hops(bytes, count, no_network(221))));
      theirs.push_back(median(bench::raw_c_hops(bytes, count)));
      ratios.push_back(static_cast<double>(ours.back()) / static_cast<double>(theirs.back()));
    }
    expect_nothing_copied(before);
    say("| %zu B | %lld | %lld | %.2f | %s |\n", bytes, static_cast<long long>(median(ours)),
        static_cast<long long>(median(theirs)), median(ratios), bytes == 64 ? "1.2" : "flat");
  }
}

void bench_remote_reader(const char* program) {
  say("\n## The same hop while a reader in another process is matched, p50\n\n");
  say("| size | network | Kervan us | target us |\n|---|---|---|---|\n");
  for (const std::size_t bytes : {std::size_t{64}, std::size_t{1} << 20}) {
    for (const Network network : {Network::sync, Network::async}) {
      const auto hops = hops_with_remote_reader(program, bytes, bytes > 100000 ? 200 : 2000, network);
      const bool async = network == Network::async;
      say("| %zu B | %s | %.1f | %s |\n", bytes, async ? "async" : "sync", static_cast<double>(median(hops)) * 1e-3,
          !async        ? "-"
          : bytes == 64 ? "5"
                        : "100");
    }
  }
}

void bench_cross_thread(int rounds) {
  std::vector<double> ours, queue, raw, ratios, raw_ratios;
  for (int round = 0; round < rounds; ++round) {
    ours.push_back(static_cast<double>(median(kervan_cross_thread_hops(1000))) * 1e-3);
    queue.push_back(static_cast<double>(median(bench::queue_hops(1000))) * 1e-3);
    raw.push_back(static_cast<double>(median(bench::raw_c_cross_thread_hops(1000))) * 1e-3);
    ratios.push_back(ours.back() / queue.back());
    raw_ratios.push_back(ours.back() / raw.back());
  }
  say("\n## One hop to another thread, 64 B at 1 kHz, p50 of %d alternating rounds\n\n", rounds);
  say("| reference | us | Kervan us | ratio | target |\n|---|---|---|---|---|\n");
  say("| mutex and condition variable alone | %.1f | %.1f | %.2f | 1.5 |\n", median(queue), median(ours),
      median(ratios));
  say("| raw C, listener and condition variable | %.1f | %.1f | %.2f | - |\n", median(raw), median(ours),
      median(raw_ratios));
}

void bench_chain(int rounds, double duration) {
  std::vector<double> ours, theirs, ratios;
  for (int round = 0; round < rounds; ++round) {
    ours.push_back(kervan_chain_cpu(10, duration) / duration * 100.0);
    theirs.push_back(bench::raw_c_chain_cpu(9, duration) / duration * 100.0);
    ratios.push_back(ours.back() / theirs.back());
  }
  say("\n## A chain of ten components at 1 kHz, CPU of one core, median of %d alternating rounds\n\n", rounds);
  say("| Kervan %% | raw C, one waitset %% | ratio | target |\n|---|---|---|---|\n");
  say("| %.2f | %.2f | %.2f | 1.3 |\n", median(ours), median(theirs), median(ratios));
}

void bench_start(const char* program, int rounds) {
  std::vector<double> times, memory;
  for (int round = 0; round < rounds; ++round) {
    const Start start = measure_start(program);
    times.push_back(start.milliseconds);
    memory.push_back(start.mebibytes);
  }
  say("\n## A container of ten components, each loaded from its module\n\n");
  say("| | median | target |\n|---|---|---|\n");
  say("| exec to the first end-to-end sample, ms | %.1f | 20 |\n", median(times));
  say("| resident memory, MiB | %.1f | 12 |\n", median(memory));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "--chain-start") == 0) return chain_start(10);
  if (argc == 3 && std::strcmp(argv[1], "--remote-reader") == 0) return remote_reader(argv[2]);
  if (argc == 5 && std::strcmp(argv[1], "--hop") == 0) {  // for a profiler
    const auto hops = kervan_hops(std::strtoul(argv[2], nullptr, 10), std::strtoul(argv[3], nullptr, 10),
                                  no_network(221), Network::sync, std::chrono::microseconds(std::atol(argv[4])));
    std::printf("%lld ns\n", static_cast<long long>(median(hops)));
    return 0;
  }
  if (argc == 2 && std::strcmp(argv[1], "--cross") == 0) {
    const auto hops = kervan_cross_thread_hops(3000);
    std::printf("%lld ns\n", static_cast<long long>(median(hops)));
    std::printf("%lld ns queue\n", static_cast<long long>(median(bench::queue_hops(3000))));
    std::printf("%lld ns raw C\n", static_cast<long long>(median(bench::raw_c_cross_thread_hops(3000))));
    return 0;
  }
  const bool smoke = bench::begin(argc, argv, "Data path");
  bench_same_thread(smoke ? 1 : 7);
  bench_remote_reader("/proc/self/exe");
  bench_cross_thread(smoke ? 1 : 9);
  bench_chain(smoke ? 1 : 5, smoke ? 0.2 : 3.0);
  bench_start("/proc/self/exe", smoke ? 1 : 15);
  return bench::end(failed);
}
