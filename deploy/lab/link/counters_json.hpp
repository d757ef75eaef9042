/// What a link did, as a row for people and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "deploy/lab/link/link_model.hpp"

namespace kervan::link {

/// One direction of a link after a run.
struct LinkReport {
  std::string from, to;
  LinkCounters counters;
  std::uint64_t overflowed = 0;     ///< copies for which the emulator had no room
  std::uint64_t undeliverable = 0;  ///< copies that the receiving interface refused
  std::uint64_t handed_over = 0;    ///< copies that it took
  Duration total_lateness{};        ///< of those, after their time: the emulator's own error
  Duration greatest_lateness{};
};

nlohmann::ordered_json to_json(const LinkReport& report);
/// The way back, for a report that another process wrote.
LinkReport link_report_of(const nlohmann::ordered_json& object);

/// A table's heading and a row for each direction that anything was sent on.
std::vector<std::vector<std::string>> rows_of(const std::vector<LinkReport>& reports);

}  // namespace kervan::link
