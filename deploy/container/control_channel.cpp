#include "deploy/container/control_channel.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <limits>

#include "deploy/container/json_reader.hpp"
#include "kervan_msgs/msg/MissionResult.hpp"

namespace kervan::container {
namespace {

using kervan_msgs::msg::MissionOutcome;
using kervan_msgs::msg::MissionResult;
using nlohmann::json;
using nlohmann::ordered_json;

/// How long a message waits for a pipe that is full.
constexpr int kLongestWaitMs = 1000;

constexpr std::array kPhases = {Phase::starting, Phase::constructed, Phase::matched, Phase::active};
constexpr std::array kOutcomes = {MissionOutcome::MISSION_SUCCESS, MissionOutcome::MISSION_FAILED,
                                  MissionOutcome::MISSION_ABORTED};

std::string_view outcome_text(MissionOutcome outcome) {
  switch (outcome) {
    case MissionOutcome::MISSION_SUCCESS: return "success";
    case MissionOutcome::MISSION_FAILED: return "failed";
    case MissionOutcome::MISSION_ABORTED: return "aborted";
  }
  return "aborted";
}

ordered_json counters_json(const Counters& counters) {
  const auto& [worst_latency_s, missed_deadlines] = counters;
  return {{"worst_latency_s", worst_latency_s}, {"missed_deadlines", missed_deadlines}};
}

Counters counters_of(const JsonReader& reader) {
  return {reader.at("worst_latency_s").number(), reader.at("missed_deadlines").integer<std::uint64_t>()};
}

/// What a run's outcome is made of; header and stamps stay behind.
ordered_json mission_json(const MissionResult& mission) {
  ordered_json robots = ordered_json::array();
  for (const auto& robot : mission.robots)
    robots.push_back({{"robot", robot.robot},
                      {"reached", robot.reached},
                      {"error_m", robot.error_m},
                      {"time_s", robot.time_s},
                      {"path_m", robot.path_m},
                      {"contacts", robot.contacts},
                      {"min_clearance_m", robot.min_clearance_m}});  // NaN becomes null
  return {{"result", outcome_text(mission.result)}, {"reason", mission.reason}, {"robots", robots}};
}

MissionResult mission_of(const JsonReader& reader) {
  MissionResult mission;
  const std::string result = reader.at("result").text();
  bool known = false;
  for (const MissionOutcome outcome : kOutcomes)
    if (outcome_text(outcome) == result) {
      mission.result = outcome;
      known = true;
    }
  if (!known) reader.at("result").fail("'" + result + "' is not one of success, failed, aborted");
  mission.reason = reader.at("reason").text();
  reader.at("robots").each([&](const JsonReader& given) {
    auto& robot = mission.robots.emplace_back();
    robot.robot = given.at("robot").text();
    robot.reached = given.at("reached").boolean();
    robot.error_m = given.at("error_m").number_or_nan();
    robot.time_s = given.at("time_s").number_or_nan();
    robot.path_m = given.at("path_m").number_or_nan();
    robot.contacts = given.at("contacts").integer<std::uint32_t>();
    robot.min_clearance_m = given.at("min_clearance_m").number_or_nan();
  });
  return mission;
}

/// The ends that to_text() knows.
runtime::RunEnd end_of(const JsonReader& reader) {
  const std::string text = reader.text();
  for (int i = 0;; ++i) {
    const auto end = static_cast<runtime::RunEnd>(i);
    const std::string_view name = runtime::to_text(end);
    if (name == text) return end;
    if (name == "unknown") reader.fail("'" + text + "' is no way for a run to end");
  }
}

ordered_json object_of(Phase phase) { return {{"phase", to_text(phase)}}; }

ordered_json object_of(const Progress& progress) {
  return {{"progress", {{"simulated_s", progress.simulated_s}, {"counters", counters_json(progress.counters)}}}};
}

ordered_json object_of(const Crash& crash) {
  const auto& [signal, address, component, handler, time_ns] = crash;
  return {{"crash",
           {{"signal", signal},
            {"address", address},
            {"component", component},
            {"handler", handler},
            {"time_ns", time_ns}}}};
}

ordered_json object_of(const Failure& failure) {
  return {{"failure", {{"message", failure.message}, {"configuration", failure.configuration}}}};
}

ordered_json object_of(const EndReport& report) {
  const auto& [container, end, reason, simulated_s, trace_hash, mission, failed, counters] = report;
  ordered_json failures = ordered_json::array();
  for (const FailedComponent& one : failed) failures.push_back({{"component", one.component}, {"reason", one.reason}});
  ordered_json object = {
      {"container", container}, {"end", runtime::to_text(end)}, {"reason", reason}, {"simulated_s", simulated_s}};
  if (trace_hash) object["trace_hash"] = hash_text(*trace_hash);
  if (mission) object["mission"] = mission_json(*mission);
  object["failed"] = failures;
  object["counters"] = counters_json(counters);
  return {{"report", object}};
}

EndReport report_of(const JsonReader& reader) {
  EndReport report;
  report.container = reader.at("container").text();
  report.end = end_of(reader.at("end"));
  report.reason = reader.at("reason").text();
  report.simulated_s = reader.at("simulated_s").number();
  if (reader.has("trace_hash")) report.trace_hash = reader.at("trace_hash").hash();
  if (reader.has("mission")) report.mission = mission_of(reader.at("mission"));
  reader.at("failed").each([&](const JsonReader& one) {
    report.failed.push_back({one.at("component").text(), one.at("reason").text()});
  });
  report.counters = counters_of(reader.at("counters"));
  return report;
}

}  // namespace

std::string_view to_text(Phase phase) {
  switch (phase) {
    case Phase::starting: return "starting";
    case Phase::constructed: return "constructed";
    case Phase::matched: return "matched";
    case Phase::active: return "active";
  }
  return "starting";
}

std::string to_line(const Message& message) {
  const ordered_json object = std::visit([](const auto& held) { return object_of(held); }, message);
  // A reason may hold what a file or a library said, in whatever encoding.
  return object.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

Message parse_line(const std::string& line) {
  const std::string shown_as = "control channel";
  const json object = parse_json(line, shown_as);
  const JsonReader reader(object, shown_as);
  if (reader.has("phase")) {
    const std::string text = reader.at("phase").text();
    for (const Phase phase : kPhases)
      if (to_text(phase) == text) return phase;
    reader.at("phase").fail("there is no phase '" + text + "'");
  }
  if (reader.has("progress")) {
    const JsonReader progress = reader.at("progress");
    return Progress{progress.at("simulated_s").number(), counters_of(progress.at("counters"))};
  }
  if (reader.has("crash")) {
    const JsonReader crash = reader.at("crash");
    return Crash{crash.at("signal").integer<int>(), crash.at("address").text(), crash.at("component").text(),
                 crash.at("handler").text(), crash.at("time_ns").integer<std::int64_t>()};
  }
  if (reader.has("failure")) {
    const JsonReader failure = reader.at("failure");
    return Failure{failure.at("message").text(), failure.at("configuration").boolean()};
  }
  return report_of(reader.at("report"));
}

std::string signal_name(int signal) {
  const char* name = sigabbrev_np(signal);
  return name ? "SIG" + std::string(name) : "signal " + std::to_string(signal);
}

std::string to_text(const Crash& crash) {
  const std::string what =
      "crashed: " + signal_name(crash.signal) + (crash.address.empty() ? "" : " at address " + crash.address);
  return crash.component.empty() ? what + " outside of any component"
                                 : what + " in " + crash.component + " (in " + crash.handler + ")";
}

ControlChannel::ControlChannel(int descriptor) : descriptor_(descriptor) {
  if (descriptor_ < 0) return;
  ::fcntl(descriptor_, F_SETFD, FD_CLOEXEC);
  ::fcntl(descriptor_, F_SETFL, ::fcntl(descriptor_, F_GETFL) | O_NONBLOCK);
}

void ControlChannel::send(const Message& message) {
  if (descriptor_ < 0) return;
  const std::string line = to_line(message) + "\n";
  const bool may_be_lost = std::holds_alternative<Progress>(message);
  const std::lock_guard lock(mutex_);
  for (std::size_t written = 0; written < line.size();) {
    const ssize_t size = ::write(descriptor_, line.data() + written, line.size() - written);
    if (size >= 0) {
      written += static_cast<std::size_t>(size);
    } else if (errno == EAGAIN) {
      if (may_be_lost && written == 0) return;
      pollfd writable{descriptor_, POLLOUT, 0};
      if (::poll(&writable, 1, kLongestWaitMs) == 0) return;
    } else if (errno != EINTR) {
      return;
    }
  }
}

std::vector<std::string> ControlReader::read_lines(int descriptor, bool& open) {
  std::array<char, 4096> buffer{};
  open = true;
  for (;;) {
    const ssize_t size = ::read(descriptor, buffer.data(), buffer.size());
    if (size > 0) {
      rest_.append(buffer.data(), static_cast<std::size_t>(size));
      continue;
    }
    if (size < 0 && errno == EINTR) continue;
    open = size < 0 && errno == EAGAIN;
    break;
  }
  std::vector<std::string> lines;
  std::size_t begin = 0;
  for (std::size_t end; (end = rest_.find('\n', begin)) != std::string::npos; begin = end + 1)
    lines.push_back(rest_.substr(begin, end - begin));
  rest_.erase(0, begin);
  return lines;
}

}  // namespace kervan::container
