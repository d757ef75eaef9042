/// A writer that publishes ten times what its reader can take, for a minute: what becomes of memory, of the samples
/// that are too many, and of everybody else's deadlines. Once in one container, once over the network.
#include <unistd.h>

#include <cinttypes>
#include <fstream>
#include <optional>
#include <string>
#include <thread>

#include "bench_msgs/msg/Payload.hpp"
#include "framework/kervan.hpp"
#include "framework/runtime/container.hpp"
#include "framework/test/harness.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/statistics.hpp"

namespace {

using namespace kervan;
using namespace std::chrono_literals;
using bench::now_ns;
using bench::say;
using bench_msgs::msg::Payload;

constexpr Duration slow_work = 1ms;   ///< of the slow reader, for each sample
constexpr Duration flood_tick = 5ms;  ///< a burst a tick: finer timers would measure the timers
constexpr int burst = 50;             ///< 10,000 samples a second, ten times what the reader can take
constexpr std::size_t sample_bytes = 1000;

void publish(Output<Payload>& out, std::size_t bytes) {
  auto message = out.loan_uncleared();
  message->data.resize(bytes);
  message->stamp = now_ns();
  out.publish(std::move(message));
}

class Flood final : public Component {
  Output<Payload> out_{this, "out", qos::event, "Far too many."};
  Timer tick_{this, flood_tick, &Flood::on_tick};
  void on_tick(Time) {
    for (int i = 0; i < burst; ++i) publish(out_, sample_bytes);
  }
};

/// Its work blocks, so it asks for a thread of its own.
class SlowReader final : public Component {
  Input<Payload> in_{this, "in", qos::event, &SlowReader::on_message, "Takes long over each."};
  void on_message(const Payload&, Time) { std::this_thread::sleep_for(slow_work); }

 public:
  SlowReader() { wants_own_thread(); }
};

/// The rest of the composition: a command at 20 Hz and whoever counts on it.
class Commander final : public Component {
  Output<Payload> out_{this, "out", qos::command, "A command."};
  Timer tick_{this, 50ms, &Commander::on_tick};
  void on_tick(Time) { publish(out_, 64); }
};

class Drive final : public Component {
  Input<Payload> in_{this, "in", qos::command, &Drive::on_command, "Commands, at least every 250 ms."};
  void on_command(const Payload&, Time) {}
};

struct Classes {
  ComponentClass flood = test::define<Flood>("bench/flood");
  ComponentClass slow = test::define<SlowReader>("bench/slow_reader");
  ComponentClass commander = test::define<Commander>("bench/commander");
  ComponentClass drive = test::define<Drive>("bench/drive");
} classes;

runtime::ContainerSpec spec_of(const std::string& name, bool split) {
  runtime::ContainerSpec spec;
  spec.name = name;
  spec.log_to_console = spec.publish_log = false;
  // Two domains of one process meet on the network as two processes do, and their memory is seen at once.
  spec.domain = {.id = name == "readers" ? 227u : 226u, .network = split, .interface = "lo"};
  if (split) {
    spec.members = {"writers", "readers"};
    spec.domain.tag = "overload-" + std::to_string(getpid());
    spec.domain.external_id = 226;
  }
  const auto add = [&](const ComponentClass& type, PortDirection direction, const char* port, const char* topic,
                       const char* profile) {
    const bool writes = direction == PortDirection::output;
    const TypeSupport& payload = type_support<Payload>();
    spec.components.push_back({.name = std::string(type.type).substr(6),
                               .type = type.type,
                               .container = split ? (writes ? "writers" : "readers") : "",
                               .ports = {{.port = port,
                                          .topic = topic,
                                          .profile = *builtin_profile(profile),
                                          .direction = direction,
                                          .type = payload.name,
                                          .layout_hash = payload.layout_hash}}});
  };
  add(classes.flood, PortDirection::output, "out", "/flood", "event");
  add(classes.commander, PortDirection::output, "out", "/command", "command");
  add(classes.slow, PortDirection::input, "in", "/flood", "event");
  add(classes.drive, PortDirection::input, "in", "/command", "command");
  return spec;
}

double resident_mib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmRSS:")) return static_cast<double>(std::atol(line.c_str() + 6)) / 1024.0;
  return 0.0;
}

struct Result {
  double early_mib = 0.0;  ///< after a tenth of the time: caches and pools have filled
  double end_mib = 0.0;
  double most_mib = 0.0;
  std::uint64_t published = 0;
  runtime::PortCounters slow, drive;
};

Result overload(bool split, Duration time) {
  ComponentRegistry registry({});
  for (const ComponentClass* type : {&classes.flood, &classes.slow, &classes.commander, &classes.drive})
    registry.add(*type);
  runtime::Container writers(spec_of(split ? "writers" : "all", split), registry);
  std::optional<runtime::Container> readers;
  if (split) readers.emplace(spec_of("readers", split), registry);

  Result result;
  std::optional<Time> begin;
  const runtime::RunControl control{.limit = time, .progress = [&](Time now) {
                                      if (!begin) begin = now;
                                      const double mib = resident_mib();
                                      if (now - *begin < time / 10) result.early_mib = mib;
                                      result.most_mib = std::max(result.most_mib, mib);
                                    }};
  std::thread other;
  if (readers) other = std::thread([&] { readers->run({.limit = time}); });
  writers.run(control);
  if (other.joinable()) other.join();
  result.end_mib = resident_mib();
  result.published = writers.find("flood")->outputs().front()->published();
  runtime::Container& reading = readers ? *readers : writers;
  result.slow = reading.find("slow_reader")->inputs().front()->counters();
  result.drive = reading.find("drive")->inputs().front()->counters();
  return result;
}

bool failed = false;

void expect(bool holds, const char* what) {
  if (holds) return;
  say("FAILED: %s\n", what);
  failed = true;
}

void bench_overload(bool split, Duration time) {
  const Result r = overload(split, time);
  const std::uint64_t dropped = r.slow.overwritten + r.slow.refused + r.slow.expired;
  say("| %s | %" PRIu64 " | %" PRIu64 " | %" PRIu64 " | %.1f / %.1f / %.1f | %" PRIu64 " | %" PRIu64 " |\n",
      split ? "over the network" : "one container", r.published, r.slow.handled, dropped, r.early_mib, r.most_mib,
      r.end_mib, r.drive.handled, r.drive.deadline_missed);
  expect(dropped > 0, "nothing was dropped, so nothing was overloaded");
  // What arrived has an account: handled, dropped, or still waiting, which the profile's depth bounds.
  const std::uint64_t waiting =
      r.slow.received - std::min(r.slow.received, r.slow.handled + r.slow.overwritten + r.slow.expired);
  expect(waiting <= 100, "samples disappeared without being counted");
  expect(r.most_mib - r.early_mib < 8.0, "memory grows");
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = bench::begin(argc, argv, "Overload");
  const Duration time = smoke ? Duration(1500ms) : Duration(60s);
  say("\n## Ten times what a slow reader can take, for %.0f s\n\n", seconds(time));
  say("| | published | handled | dropped, counted | resident MiB early / most / end | commands heard | deadlines "
      "missed |\n");
  say("|---|---|---|---|---|---|---|\n");
  for (const bool split : {false, true}) bench_overload(split, time);
  return bench::end(failed);
}
