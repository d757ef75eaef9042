#include "deploy/cli/run_composition.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "deploy/composition/hosts.hpp"
#include "deploy/container/mission_listener.hpp"
#include "deploy/container/specification.hpp"
#include "deploy/lab/link/emulated_network.hpp"
#include "framework/runtime/container.hpp"

namespace kervan::cli {
namespace {

namespace fs = std::filesystem;

/// A run under lockstep in several containers meets nobody else: the processes of one host agree on the supervisor's
/// number, those of several hosts on the composition's name.
std::string tag_of(const composition::ResolvedComposition& composition) {
  for (const composition::Host& host : composition.source.domain.hosts)
    if (!host.address.empty()) return composition.source.name;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return composition.source.name + "-" + std::to_string(::getpid()) + "-" + std::to_string(now.count());
}

supervisor::SupervisedRun run_here(const runtime::ContainerSpec& spec, ComponentRegistry& registry,
                                   const RunOptions& options, const RunEvents& events) {
  using Clock = std::chrono::steady_clock;
  container::add_mission_listener(registry);
  runtime::Container container(spec, registry);
  runtime::RunControl control;
  control.limit = options.time_limit;
  control.stop = options.stop;
  control.progress = [&](Time now) {
    if (events.progress) events.progress(now.time_since_epoch());
  };
  supervisor::SupervisedRun run;
  const Clock::time_point start = Clock::now();
  run.reports.push_back(container::run_to_end(container, control));
  run.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  run.containers.push_back({spec.name, ::getpid(), 0, "", run.reports.front().counters});
  return run;
}

/// The hosts that have containers, as the composition says they are joined.
std::unique_ptr<link::EmulatedNetwork> emulate(const composition::Composition& composition) {
  std::vector<link::EmulatedHost> hosts;
  for (const composition::Host& host : composition.domain.hosts)
    if (std::ranges::find(composition.containers, host.name, &composition::Container::host) !=
        composition.containers.end())
      hosts.push_back({host.name, host.interface, host.address});
  return std::make_unique<link::EmulatedNetwork>(hosts, composition.links);
}

supervisor::SupervisedRun run_supervised(const composition::ResolvedComposition& composition,
                                         std::vector<runtime::ContainerSpec> specs, const RunOptions& options,
                                         const RunEvents& events, link::EmulatedNetwork* network) {
  supervisor::SupervisorConfig config;
  config.program = container_program();
  config.spec_folder = fs::absolute(options.run_folder);
  config.limit = options.time_limit;
  const auto here = composition::containers_here(composition.source);
  for (std::size_t i = 0; i < specs.size(); ++i) {
    const composition::Container& container = composition.source.containers[i];
    if (std::ranges::find(here, &container) != here.end())
      config.containers.push_back(
          {std::move(specs[i]), container.restart, network ? network->namespace_of(container.host) : -1});
  }
  supervisor::SupervisorEvents shown{events.say, events.waiting, events.progress, {}};
  if (network) {
    config.trouble = [network] { return network->trouble(); };
    shown.all_active = [network] { network->begin(); };
  }
  supervisor::Supervisor supervisor(std::move(config), std::move(shown));
  return supervisor.run();
}

}  // namespace

fs::path container_program() {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  const fs::path program = folder / "kervan-container";
  if (error || ::access(program.c_str(), X_OK) != 0)
    throw ConfigError({program.string(), 0, 0}, "cannot be started; it belongs beside the program kervan");
  return program;
}

bool runs_here(const composition::ResolvedComposition& composition) {
  return composition.source.containers.size() == 1 && composition.source.clock.mode == composition::ClockMode::lockstep;
}

RunOutcome run_composition(const composition::ResolvedComposition& composition, ComponentRegistry& registry,
                           const RunOptions& options, const RunEvents& events) {
  const bool here = runs_here(composition);
  auto specs = container::specifications(composition, {.run_folder = fs::absolute(options.run_folder),
                                                       .threads = options.threads,
                                                       .log_to_console = options.log_to_console,
                                                       .tag = here ? "" : tag_of(composition)});
  const auto network = composition.source.emulate_hosts ? emulate(composition.source) : nullptr;
  const supervisor::SupervisedRun run =
      here ? run_here(specs.front(), registry, options, events)
           : run_supervised(composition, std::move(specs), options, events, network.get());
  if (run.unusable) throw ConfigError({}, run.aborted);
  RunOutcome outcome = judge(run);
  if (network) outcome.links = network->end();
  return outcome;
}

}  // namespace kervan::cli
