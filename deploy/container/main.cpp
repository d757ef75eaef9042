// kervan-container: the process that hosts the components of one container.
//
//   kervan-container SPEC.json NAME [--control-fd N] [--for-ns N]
//
// SPEC.json is what spec_json.hpp writes, NAME the container it must be for. On the descriptor of --control-fd it tells
// its supervisor how it is (control_channel.hpp). --for-ns ends the run after so many nanoseconds of the composition's
// clock. SIGINT and SIGTERM end the run in good order; the second one ends the process.
//
// Exit codes: 0 ended in good order, 1 the run broke off, 2 it could not begin: wrong usage or configuration.
#include <signal.h>

#include <atomic>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "deploy/container/changes.hpp"
#include "deploy/container/control_channel.hpp"
#include "deploy/container/crash_report.hpp"
#include "deploy/container/mission_listener.hpp"
#include "deploy/container/notify.hpp"
#include "deploy/container/report.hpp"
#include "deploy/container/service.hpp"
#include "deploy/container/spec_json.hpp"
#include "framework/component/error.hpp"

using namespace kervan;

namespace {

constexpr int exit_good = 0, exit_broken_off = 1, exit_unusable = 2;

std::atomic<bool> stop_wanted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

extern "C" void on_signal(int) {
  stop_wanted = true;
  ::signal(SIGINT, SIG_DFL);
  ::signal(SIGTERM, SIG_DFL);
}

struct Options {
  std::string spec_file, name;
  int control = -1;
  Duration limit = forever;
};

template <class Number>
Number number_of(const std::string& option, const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 0)
    throw ConfigError({option + " " + text, 0, 0}, "must be a whole number, 0 or more");
  return number;
}

Options options_of(const std::vector<std::string>& arguments) {
  Options options;
  std::vector<std::string> plain;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (!argument.starts_with("--")) {
      plain.push_back(argument);
      continue;
    }
    if (argument != "--control-fd" && argument != "--for-ns")
      throw ConfigError({}, "there is no option " + argument + "; allowed: --control-fd, --for-ns");
    if (++i == arguments.size()) throw ConfigError({}, argument + " needs a value");
    if (argument == "--control-fd")
      options.control = number_of<int>(argument, arguments[i]);
    else
      options.limit = Duration(number_of<std::int64_t>(argument, arguments[i]));
  }
  if (plain.size() != 2) throw ConfigError({}, "usage: kervan-container SPEC.json NAME [--control-fd N] [--for-ns N]");
  options.spec_file = plain[0];
  options.name = plain[1];
  return options;
}

runtime::ContainerSpec spec_of(const Options& options) {
  runtime::ContainerSpec spec = container::read_spec(options.spec_file);
  if (spec.name != options.name)
    throw ConfigError({options.spec_file, 0, 0},
                      "is for the container '" + spec.name + "', not '" + options.name + "'");
  return spec;
}

/// Throws what the construction throws. The channel hears of everything on the way. `began` becomes true when what
/// still goes wrong is no mistake of the configuration any more.
container::EndReport host(const runtime::ContainerSpec& spec, const container::Changes& changes, Duration limit,
                          container::ControlChannel& channel, bool& began) {
  const container::ServiceManager manager;
  ComponentRegistry registry(ComponentRegistry::default_folders());
  container::add_mission_listener(registry);
  std::optional<runtime::Container> container(std::in_place, spec, registry);
  std::optional<container::ContainerService> service;
  service.emplace(*container, registry, [&] { changes.keep(container->spec()); });
  began = true;
  channel.send(container::Phase::constructed);
  manager.say("STATUS=waiting for the other containers");

  runtime::RunControl control;
  control.limit = limit;
  control.stop = &stop_wanted;
  control.phase = [&](runtime::RunPhase phase) {
    channel.send(phase == runtime::RunPhase::matched ? container::Phase::matched : container::Phase::active);
    manager.say(phase == runtime::RunPhase::matched ? "STATUS=matched" : "READY=1\nSTATUS=active");
  };
  std::optional<Time> start;
  control.progress = [&](Time now) {
    if (!start) start = now;
    const Duration passed = spec.clock == runtime::ClockMode::wall ? now - *start : now.time_since_epoch();
    channel.send(container::Progress{seconds(passed), container::counters_of(*container)});
    if (manager.watchdog() == forever) return;
    const std::string hanging = container::hanging_component(*container, manager.watchdog() / 2);
    manager.say(hanging.empty() ? "WATCHDOG=1" : "STATUS=" + hanging);
  };
  container::EndReport report = container::run_to_end(*container, control);
  manager.say("STOPPING=1\nSTATUS=" + report.reason);
  // Taken apart before the report goes out: after the report the supervisor expects the end of the process.
  service.reset();
  container.reset();
  return report;
}

int run(const Options& options, container::ControlChannel& channel, bool& began) {
  runtime::ContainerSpec spec = spec_of(options);
  const container::Changes changes(spec);
  const auto crash_file =
      spec.run_folder.empty() ? std::filesystem::path() : spec.run_folder / ("crash-" + spec.name + ".txt");
  container::report_crashes({spec.name, crash_file, options.control});
  channel.send(container::Phase::starting);
  const container::EndReport report = host(spec, changes, options.limit, channel, began);
  channel.send(report);
  using runtime::RunEnd;
  return report.end == RunEnd::finished || report.end == RunEnd::time_limit || report.end == RunEnd::interrupted
             ? exit_good
             : exit_broken_off;
}

}  // namespace

int main(int argc, char** argv) {
  ::signal(SIGINT, on_signal);
  ::signal(SIGTERM, on_signal);
  ::signal(SIGPIPE, SIG_IGN);
  Options options;
  try {
    options = options_of({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "kervan-container: %s\n", error.what());
    return exit_unusable;
  }
  container::ControlChannel channel(options.control);
  bool began = false;
  try {
    return run(options, channel, began);
  } catch (const std::exception& error) {
    channel.send(container::Failure{error.what(), !began});
    if (options.control < 0) std::fprintf(stderr, "kervan-container: %s: %s\n", options.name.c_str(), error.what());
    return began ? exit_broken_off : exit_unusable;
  }
}
