/// Runs a resolved composition in this process. Everything that a person could have written wrongly was refused before.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "deploy/composition/resolve.hpp"
#include "framework/component/registry.hpp"

namespace kervan::cli {

enum class RunResult {
  success,  ///< the mission was accomplished; or there is none, and the run ended in good order
  failed,   ///< the mission's time was up, or a robot gave up
  aborted,  ///< ended from outside, or something broke
};

/// How one robot did, by the simulator's truth.
struct RobotOutcome {
  bool reached = false;
  double error_m = 0.0;
  double time_s = 0.0;
  double path_m = 0.0;
  std::uint32_t contacts = 0;
  std::optional<double> min_clearance_m;  ///< none if it was never measured
};

struct RunOutcome {
  RunResult result = RunResult::success;
  std::string reason;  ///< one sentence; may be empty after a success
  std::map<std::string, RobotOutcome> robots;
  std::string trace_hash;  ///< hexadecimal; empty under the wall clock
  double simulated_s = 0.0;
  double wall_s = 0.0;
};

struct RunOptions {
  std::filesystem::path run_folder;         ///< exists
  Duration time_limit = forever;            ///< on the composition's clock
  unsigned threads = 0;                     ///< 0: as the composition says
  const std::atomic<bool>* stop = nullptr;  ///< set by Ctrl-C: end in good order, with a zero command
  bool log_to_console = true;
};

/// The composition's time since the start; called about ten times a second of wall time.
using ProgressCallback = std::function<void(Duration simulated)>;

RunOutcome run_composition(const composition::ResolvedComposition& composition, ComponentRegistry& registry,
                           const RunOptions& options, const ProgressCallback& progress);

}  // namespace kervan::cli
