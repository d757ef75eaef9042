/// What came of a run, from what its containers reported.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "deploy/container/report.hpp"
#include "deploy/lab/link/counters_json.hpp"
#include "deploy/supervisor/supervisor.hpp"

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
  std::string ended;       ///< why the containers ended: "finished", "time limit", …; empty if none reported
  std::string failures;    ///< of components and containers on the way, one sentence; empty: none
  std::string trace_hash;  ///< hexadecimal; empty under the wall clock
  double simulated_s = 0.0;
  double wall_s = 0.0;
  int signal = 0;  ///< SIGINT or SIGTERM, if one ended the run
  std::vector<supervisor::ContainerRecord> containers;
  std::vector<link::LinkReport> links;  ///< of emulated hosts
};

/// The same for a run in this process and for one in several. `run.unusable` must have been dealt with before.
RunOutcome judge(const supervisor::SupervisedRun& run);

}  // namespace kervan::cli
