/// What a container says of itself, to the program it runs in or to the supervisor of its process.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "framework/runtime/container.hpp"
#include "kervan_msgs/msg/MissionResult.hpp"

namespace kervan::container {

struct Counters {
  double worst_latency_s = 0.0;        ///< from receipt to the beginning of the handler; 0 if nothing was handled
  std::uint64_t missed_deadlines = 0;  ///< of all inputs
};

struct FailedComponent {
  std::string component;
  std::string reason;
};

/// How a container's part of a run ended.
struct EndReport {
  std::string container;
  runtime::RunEnd end = runtime::RunEnd::finished;
  std::string reason;                       ///< one sentence
  double simulated_s = 0.0;                 ///< composition's time at the end; under the wall clock since the start
  std::optional<std::uint64_t> trace_hash;  ///< under lockstep, if all containers came to the end together
  std::optional<kervan_msgs::msg::MissionResult> mission;
  std::vector<FailedComponent> failed;  ///< components that failed on the way, in the composition's order
  Counters counters;
};

Counters counters_of(const runtime::Container& container);

/// Who has been in one handler for longer than this, in words; empty if nobody has. A component with a thread of its
/// own may take a minute: that is what it has it for. For the thread that runs the container.
std::string hanging_component(const runtime::Container& container, Duration longest);

/// Runs the container to its end and reports. The container's registry must have had add_mission_listener().
EndReport run_to_end(runtime::Container& container, const runtime::RunControl& control);

}  // namespace kervan::container
