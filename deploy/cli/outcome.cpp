#include "deploy/cli/outcome.hpp"

#include <algorithm>
#include <cmath>

#include "deploy/container/json_reader.hpp"

namespace kervan::cli {
namespace {

using container::EndReport;
using kervan_msgs::msg::MissionOutcome;
using kervan_msgs::msg::MissionResult;
using runtime::RunEnd;

/// What went wrong comes first, then who ended the run; the others ended because it was over.
int rank(RunEnd end) {
  switch (end) {
    case RunEnd::finished: return 1;
    case RunEnd::time_limit: return 2;
    case RunEnd::interrupted: return 3;
    default: return 0;
  }
}

std::map<std::string, RobotOutcome> robots_of(const MissionResult& mission) {
  std::map<std::string, RobotOutcome> robots;
  for (const auto& robot : mission.robots) {
    RobotOutcome& target = robots[robot.robot];
    target.reached = robot.reached;
    target.error_m = robot.error_m;
    target.time_s = robot.time_s;
    target.path_m = robot.path_m;
    target.contacts = robot.contacts;
    if (std::isfinite(robot.min_clearance_m)) target.min_clearance_m = robot.min_clearance_m;
  }
  return robots;
}

/// What failed on the way, as one sentence; empty if nothing did.
std::string failures(const supervisor::SupervisedRun& run) {
  std::string text;
  const auto add = [&](const std::string& one) { text += (text.empty() ? "" : "; ") + one; };
  for (const EndReport& report : run.reports)
    for (const auto& one : report.failed) add(one.component + " failed: " + one.reason);
  for (const std::string& one : run.given_up) add(one);
  return text;
}

void judge_mission(RunOutcome& outcome, const MissionResult& mission, RunEnd end) {
  outcome.robots = robots_of(mission);
  outcome.reason = mission.result != MissionOutcome::MISSION_ABORTED ? mission.reason
                   : end == RunEnd::time_limit  ? "the time asked for was over before the mission was"
                   : end == RunEnd::interrupted ? "interrupted before the mission was over"
                                                : mission.reason;
  outcome.result = mission.result == MissionOutcome::MISSION_SUCCESS  ? RunResult::success
                   : mission.result == MissionOutcome::MISSION_FAILED ? RunResult::failed
                                                                      : RunResult::aborted;
}

void set_trace(RunOutcome& outcome, const supervisor::SupervisedRun& run) {
  for (const EndReport& report : run.reports) {
    if (!report.trace_hash) continue;
    const std::string hash = container::hash_text(*report.trace_hash);
    if (!outcome.trace_hash.empty() && outcome.trace_hash != hash) {
      outcome.result = RunResult::aborted;
      outcome.reason = "the containers do not agree about the trace: " + outcome.trace_hash + " and " + hash;
    }
    outcome.trace_hash = hash;
  }
}

}  // namespace

RunOutcome judge(const supervisor::SupervisedRun& run) {
  RunOutcome outcome;
  outcome.containers = run.containers;
  outcome.wall_s = run.wall_s;
  outcome.signal = run.signal;
  const std::string failed = outcome.failures = failures(run);
  for (const EndReport& report : run.reports) outcome.simulated_s = std::max(outcome.simulated_s, report.simulated_s);
  const auto first =
      std::ranges::min_element(run.reports, {}, [](const EndReport& report) { return rank(report.end); });
  const auto mission =
      std::ranges::find_if(run.reports, [](const EndReport& report) { return report.mission.has_value(); });
  if (first == run.reports.end()) {
    outcome.result = RunResult::aborted;
    outcome.reason = run.signal != 0 ? "interrupted" : "no container lived to report";
  } else {
    outcome.reason = first->reason;
    outcome.ended = runtime::to_text(first->end);
    if (mission != run.reports.end()) {
      judge_mission(outcome, *mission->mission, first->end);
    } else {
      const bool good = first->end == RunEnd::finished || first->end == RunEnd::time_limit;
      outcome.result = good && failed.empty() ? RunResult::success : RunResult::aborted;
    }
    if (rank(first->end) == 0) {
      outcome.result = RunResult::aborted;
      outcome.reason = first->reason;
    }
    set_trace(outcome, run);
  }
  if (!run.aborted.empty()) {
    outcome.result = RunResult::aborted;
    outcome.reason = run.aborted;
  } else if (!failed.empty()) {
    outcome.reason = outcome.reason.empty() ? failed : outcome.reason + "; " + failed;
  }
  return outcome;
}

}  // namespace kervan::cli
