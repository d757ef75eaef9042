// The barrier before a run: nothing is published before everybody who wants to hear it can.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "framework/dds/wall_clock.hpp"
#include "framework/runtime/container.hpp"
#include "framework/runtime/fences.hpp"
#include "framework/runtime/log.hpp"
#include "framework/runtime/members.hpp"
#include "framework/runtime/watch.hpp"

namespace kervan::runtime {

namespace {

using kervan_msgs::msg::ContainerPhase;
using kervan_msgs::msg::ContainerStatus;
using Clock = std::chrono::steady_clock;

/// The stop flag is set by a signal handler, so it has to be looked at now and then.
constexpr Duration kLookPeriod = std::chrono::milliseconds(100);
constexpr Duration kTellPeriod = std::chrono::seconds(5);
/// How long a container that was restarted into a running composition waits for those that are not there.
constexpr Duration kGrace = std::chrono::seconds(2);
constexpr std::size_t kMostTold = 4;

/// Why the container `name`, which must be `wanted` (matched or ready), holds up the start; empty if it does not.
std::string what_is_missing(const std::string& name, const std::map<std::string, Members::Other>& others,
                            std::uint64_t composition, ContainerPhase wanted) {
  const auto found = others.find(name);
  if (found == others.end()) return "container '" + name + "' is not there";
  if (!found->second.answers) return "container '" + name + "' does not answer";
  const ContainerStatus& other = found->second.status;
  if (other.composition != composition)
    return "container '" + name + "' (pid " + std::to_string(other.pid) + " on " + other.host +
           ") runs another composition: start it from the same file";
  switch (other.phase) {
    case ContainerPhase::CONTAINER_STARTING: return "container '" + name + "' is not matched with all others";
    case ContainerPhase::CONTAINER_FAILED: return "container '" + name + "' failed: " + other.reason;
    case ContainerPhase::CONTAINER_MATCHED:
      return wanted == ContainerPhase::CONTAINER_READY
                 ? "container '" + name + "' has not heard that all others are matched"
                 : std::string();
    case ContainerPhase::CONTAINER_READY:
    case ContainerPhase::CONTAINER_ACTIVE:
    case ContainerPhase::CONTAINER_FINISHED: return {};
  }
  return {};
}

/// "a; b; c; d; and 7 more"
std::string enumerated(const std::vector<std::string>& parts) {
  std::string text;
  for (std::size_t i = 0; i < std::min(parts.size(), kMostTold); ++i) text += (i == 0 ? "" : "; ") + parts[i];
  if (parts.size() > kMostTold) text += "; and " + std::to_string(parts.size() - kMostTold) + " more";
  return text;
}

}  // namespace

/// Runs in the watch's thread.
void Container::hear_members() {
  if (!members_) return;
  for (const auto& [name, other] : members_->others())
    if (other.status.phase == ContainerPhase::CONTAINER_FINISHED &&
        other.status.composition == members_->composition() && std::ranges::count(spec_.members, name) > 0)
      request_finish(~0U, other.status.reason);  // after any component of this container
}

std::optional<RunReport> Container::wait_for_peers(const RunControl& control) {
  const auto reached = [&](RunPhase phase) {
    if (control.phase) control.phase(phase);
  };
  if (!members_) {
    reached(RunPhase::matched);
    return std::nullopt;
  }
  members_->publish(ContainerPhase::CONTAINER_STARTING, {}, dds::wall_now());
  const Clock::time_point start = Clock::now();
  Clock::time_point tell = start + kTellPeriod;
  std::optional<Clock::time_point> runs_since;  // others are active already: this container was restarted
  bool matched = false;
  // Two rounds: what others said before this container was there may reach it a while after it has reached them, and
  // whoever became active meanwhile would be heard by nobody.
  bool ready = false;
  for (;;) {
    std::vector<std::string> missing = watch_->missing_pairs();
    if (!matched && missing.empty()) {
      matched = true;
      members_->publish(ContainerPhase::CONTAINER_MATCHED, {}, dds::wall_now());
      reached(RunPhase::matched);
    }
    const auto others = members_->others();
    const auto ask_all = [&](ContainerPhase wanted) {
      for (const std::string& member : spec_.members) {
        if (member == spec_.name) continue;
        std::string why = what_is_missing(member, others, members_->composition(), wanted);
        if (!why.empty()) missing.push_back(std::move(why));
      }
      return missing.empty();
    };
    if (!ready && ask_all(ContainerPhase::CONTAINER_MATCHED)) {
      ready = true;
      members_->publish(ContainerPhase::CONTAINER_READY, {}, dds::wall_now());
    }
    if (ready && ask_all(ContainerPhase::CONTAINER_READY)) return std::nullopt;

    const Clock::time_point now = Clock::now();
    const LogTime log_time(dds::wall_now());
    if (!runs_since && std::ranges::any_of(others, [](const auto& other) {
          return other.second.answers && other.second.status.phase == ContainerPhase::CONTAINER_ACTIVE;
        }))
      runs_since = now;
    if (runs_since && now - *runs_since >= kGrace) {
      log_->warn("the others are running, so this container becomes active too, although: {}", enumerated(missing));
      return std::nullopt;
    }
    if (now >= tell) {
      log_->warn("waiting for {:.0f} s: {}", std::chrono::duration<double>(now - start).count(), enumerated(missing));
      tell += kTellPeriod;
    }
    if (const auto wish = finish_wish()) return RunReport{.end = wish->end, .reason = wish->reason};
    if (control.stop && control.stop->load(std::memory_order_relaxed))
      return RunReport{.end = RunEnd::interrupted, .reason = "interrupted"};
    watch_->wait_for_change(kLookPeriod);
  }
}

}  // namespace kervan::runtime
