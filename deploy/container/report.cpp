#include "deploy/container/report.hpp"

#include <algorithm>
#include <chrono>

#include "deploy/container/mission_listener.hpp"

namespace kervan::container {

Counters counters_of(const runtime::Container& container) {
  Counters counters;
  for (const auto& instance : container.instances()) {
    counters.worst_latency_s = std::max(counters.worst_latency_s, seconds(instance->worst_latency()));
    counters.missed_deadlines += instance->missed_deadlines();
  }
  return counters;
}

std::string hanging_component(const runtime::Container& container, Duration longest) {
  constexpr Duration kOwnThread = std::chrono::minutes(1);
  for (const auto& instance : container.instances()) {
    const Duration inside = instance->time_in_handler();
    if (inside > (instance->wants_own_thread() ? std::max(longest, kOwnThread) : longest))
      return instance->name() + " has been in a handler for " +
             std::to_string(std::chrono::round<std::chrono::seconds>(inside).count()) + " s";
  }
  return {};
}

EndReport run_to_end(runtime::Container& container, const runtime::RunControl& control) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const runtime::RunReport run = container.run(control);
  EndReport report;
  report.container = container.spec().name;
  report.end = run.end;
  report.reason = run.reason;
  report.simulated_s = container.spec().clock == runtime::ClockMode::wall
                           ? std::chrono::duration<double>(Clock::now() - start).count()
                           : seconds(run.ended_at);
  if (container.spec().clock == runtime::ClockMode::lockstep && !run.broken_off)
    report.trace_hash = container.trace_hash();
  report.mission = mission_result(container);
  for (const auto& instance : container.instances())
    if (instance->state() == ComponentState::failed) report.failed.push_back({instance->name(), instance->reason()});
  report.counters = counters_of(container);
  return report;
}

}  // namespace kervan::container
