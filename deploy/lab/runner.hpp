/// Makes the runs of a plan, each in a process of its own, several at a time. It does not know what a run is: lockstep
/// or live is in the command.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "deploy/lab/run_record.hpp"

namespace kervan::lab {

struct Run {
  std::string name;                    ///< of its folder
  std::vector<std::string> arguments;  ///< of the program; "--out FOLDER" is added
  std::uint64_t fingerprint = 0;       ///< of everything that its result depends on
};

struct RunnerOptions {
  std::filesystem::path program;  ///< kervan
  std::filesystem::path folder;   ///< that holds the runs' folders
  unsigned jobs = 1;              ///< processes at a time
  std::chrono::duration<double> wall_limit{600.0};
  const std::atomic<bool>* stop = nullptr;  ///< once set, what runs is killed and nothing more begins
};

struct RunnerProgress {
  std::size_t total = 0;  ///< runs of the plan
  std::size_t kept = 0;   ///< of them, those that were done before
  std::size_t made = 0;   ///< those that came to an end now, failed ones too
  std::size_t failed = 0;
  double wall_s = 0.0;  ///< since the beginning
};

struct RunnerEvents {
  std::function<void(const RunnerProgress&)> progress;  ///< ten times a second, and at the end
  /// A run came to an end. May throw, which kills what runs and ends the plan.
  std::function<void(std::size_t run, const RunRecord&)> made;
};

/// Runs that are done are kept as they are; all others begin with an empty folder. Returns one record for each run, in
/// their order; nothing if it was stopped. To be called from the main thread (ChildProcess says why).
std::optional<std::vector<RunRecord>> make_runs(const std::vector<Run>& runs, const RunnerOptions& options,
                                                const RunnerEvents& events);

}  // namespace kervan::lab
