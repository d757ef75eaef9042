/// Runs a resolved composition: under clock lockstep in one container in this process, else each container in a process
/// of its own, supervised. Everything that a person could have written wrongly was refused before.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

#include "deploy/cli/outcome.hpp"
#include "deploy/composition/resolve.hpp"
#include "framework/component/registry.hpp"

namespace kervan::cli {

struct RunOptions {
  std::filesystem::path run_folder;         ///< exists
  Duration time_limit = forever;            ///< on the composition's clock
  unsigned threads = 0;                     ///< 0: as the composition says
  const std::atomic<bool>* stop = nullptr;  ///< of a run in this process: end in good order, with a zero command
  bool log_to_console = true;
};

/// What a person may be shown on the way; called from run_composition().
struct RunEvents {
  std::function<void(Duration simulated)> progress;  ///< the composition's time since the start, ten times a second
  std::function<void(const std::string&)> say;       ///< something happened to a container
  std::function<void(const std::string&)> waiting;   ///< whom the start waits for
};

/// The program that hosts a container, beside this one. Throws ConfigError if it is not there.
std::filesystem::path container_program();

/// Whether the composition runs in this process: there is nothing to start again under lockstep, and nothing to split.
bool runs_here(const composition::ResolvedComposition& composition);

/// Throws what the construction of a container throws; ConfigError if another process could not construct its own.
RunOutcome run_composition(const composition::ResolvedComposition& composition, ComponentRegistry& registry,
                           const RunOptions& options, const RunEvents& events);

}  // namespace kervan::cli
