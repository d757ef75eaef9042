// From a resolved composition to a container, and from its mission's result to an outcome.
#include "deploy/cli/run_composition.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>

#include "framework/component/component.hpp"
#include "framework/runtime/container.hpp"
#include "kervan_msgs/msg/MissionResult.hpp"

namespace kervan::cli {
namespace {

using kervan_msgs::msg::MissionOutcome;
using kervan_msgs::msg::MissionResult;

constexpr const char* kMissionResultType = "kervan_msgs::msg::MissionResult";

/// Hears how the mission ended. It runs as the last component of the container and publishes nothing, so the run is the
/// same with and without it.
class MissionListener final : public Component {
  Input<MissionResult> result_{this, "result", qos::latched, &MissionListener::on_result, "How the mission ended."};
  void on_result(const MissionResult& result, Time) { heard = result; }

 public:
  static inline std::optional<MissionResult> heard;
};

const ComponentClass mission_listener{
    "kervan/mission_listener", "Hears how the mission ended.",
    []() -> std::unique_ptr<Component> { return std::make_unique<MissionListener>(); }};

runtime::ContainerSpec container_spec(const composition::ResolvedComposition& composition, const RunOptions& options) {
  runtime::ContainerSpec spec;
  const composition::Container& container = composition.source.containers.front();
  spec.name = container.name;
  spec.clock = composition.source.clock.mode == composition::ClockMode::lockstep ? runtime::ClockMode::lockstep
                                                                                 : runtime::ClockMode::wall;
  spec.threads = options.threads != 0 ? options.threads : static_cast<unsigned>(container.threads);
  spec.domain.id = static_cast<std::uint32_t>(composition.source.domain.id);
  // A lockstep run in one container needs no network, and nobody may disturb it.
  spec.domain.network = spec.clock == runtime::ClockMode::wall;
  if (!composition.source.domain.hosts.empty() && !composition.source.domain.hosts.front().interface.empty())
    spec.domain.interface = composition.source.domain.hosts.front().interface;
  spec.run_folder = options.run_folder;
  spec.log_to_console = options.log_to_console;
  for (const composition::ResolvedComponent& component : composition.components) {
    runtime::ComponentSpec& target = spec.components.emplace_back();
    target.name = component.name;
    target.type = component.manifest.type;
    target.parameters = component.parameters;
    target.log_level = component.log_level;
    for (const composition::ResolvedPort& port : component.ports)
      target.ports.push_back({.port = port.info.name,
                              .topic = port.topic,
                              .profile = composition.topics.at(port.topic).qos.profile,
                              .direction = port.info.direction,
                              .type = port.info.type,
                              .layout_hash = port.info.layout_hash,
                              .optional = port.info.qos.is_optional()});
  }
  for (const auto& [name, topic] : composition.topics) {
    if (topic.type != kMissionResultType || topic.writers.empty()) continue;
    spec.components.push_back({.name = "kervan/mission_listener",
                               .type = mission_listener.type,
                               .ports = {{.port = "result", .topic = name, .profile = topic.qos.profile}}});
    break;
  }
  return spec;
}

/// The components that failed on the way, as one sentence; empty if none did.
std::string failures(const runtime::Container& container) {
  std::string text;
  for (const auto& instance : container.instances())
    if (instance->state() == ComponentState::failed)
      text += (text.empty() ? "" : "; ") + instance->name() + " failed: " + instance->reason();
  return text;
}

void judge(RunOutcome& outcome, const runtime::RunReport& report, const std::string& failed) {
  using runtime::RunEnd;
  outcome.reason = report.reason;
  const std::optional<MissionResult>& mission = MissionListener::heard;
  if (mission) {
    for (const auto& robot : mission->robots) {
      RobotOutcome& target = outcome.robots[robot.robot];
      target.reached = robot.reached;
      target.error_m = robot.error_m;
      target.time_s = robot.time_s;
      target.path_m = robot.path_m;
      target.contacts = robot.contacts;
      if (std::isfinite(robot.min_clearance_m)) target.min_clearance_m = robot.min_clearance_m;
    }
    outcome.reason = mission->result != MissionOutcome::MISSION_ABORTED ? mission->reason
                     : report.end == RunEnd::time_limit  ? "the time asked for was over before the mission was"
                     : report.end == RunEnd::interrupted ? "interrupted before the mission was over"
                                                         : mission->reason;
    outcome.result = mission->result == MissionOutcome::MISSION_SUCCESS  ? RunResult::success
                     : mission->result == MissionOutcome::MISSION_FAILED ? RunResult::failed
                                                                         : RunResult::aborted;
  } else {
    const bool good = report.end == RunEnd::finished || report.end == RunEnd::time_limit;
    outcome.result = good && failed.empty() ? RunResult::success : RunResult::aborted;
  }
  if (report.end == RunEnd::livelock || report.end == RunEnd::idle) {
    outcome.result = RunResult::aborted;
    outcome.reason = report.reason;
  }
  if (!failed.empty()) outcome.reason = outcome.reason.empty() ? failed : outcome.reason + "; " + failed;
}

}  // namespace

RunOutcome run_composition(const composition::ResolvedComposition& composition, ComponentRegistry& registry,
                           const RunOptions& options, const ProgressCallback& progress) {
  registry.add(mission_listener);
  MissionListener::heard.reset();
  runtime::Container container(container_spec(composition, options), registry);

  using Clock = std::chrono::steady_clock;
  const Clock::time_point wall_start = Clock::now();
  std::optional<Time> start;
  runtime::RunControl control;
  control.limit = options.time_limit;
  control.stop = options.stop;
  control.progress = [&](Time now) {
    if (!start) start = now;
    if (progress) progress(now - *start);
  };
  const runtime::RunReport report = container.run(control);

  RunOutcome outcome;
  outcome.wall_s = std::chrono::duration<double>(Clock::now() - wall_start).count();
  const bool lockstep = container.spec().clock == runtime::ClockMode::lockstep;
  outcome.simulated_s = lockstep ? seconds(report.ended_at) : outcome.wall_s;
  if (lockstep) {
    char hash[17];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(container.trace_hash()));
    outcome.trace_hash = hash;
  }
  judge(outcome, report, failures(container));
  return outcome;
}

}  // namespace kervan::cli
