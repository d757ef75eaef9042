#include "deploy/lab/link/counters_json.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace kervan::link {
namespace {

using nlohmann::ordered_json;

/// Every number of a report under its name, in the order of the JSON object.
template <class Report, class Visitor>
void visit_counts(Report& report, Visitor&& visit) {
  visit("packets", report.counters.packets);
  visit("bytes", report.counters.bytes);
  visit("delivered", report.counters.delivered);
  visit("delivered_bytes", report.counters.delivered_bytes);
  visit("lost", report.counters.lost);
  visit("lost_in_burst", report.counters.lost_in_burst);
  visit("queue_full", report.counters.queue_full);
  visit("down", report.counters.down);
  visit("overflowed", report.overflowed);
  visit("undeliverable", report.undeliverable);
  visit("duplicated", report.counters.duplicated);
  visit("reordered", report.counters.reordered);
  visit("corrupted", report.counters.corrupted);
  visit("delayed", report.counters.delayed);
  visit("handed_over", report.handed_over);
}

template <class Report, class Visitor>
void visit_times(Report& report, Visitor&& visit) {
  visit("total_delay_s", report.counters.total_delay);
  visit("longest_delay_s", report.counters.longest_delay);
  visit("total_lateness_s", report.total_lateness);
  visit("greatest_lateness_s", report.greatest_lateness);
}

std::string decimal(double value, const char* format) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

double mean_ms(Duration total, std::uint64_t count) {
  return count == 0 ? 0.0 : 1e3 * seconds(total) / static_cast<double>(count);
}

}  // namespace

ordered_json to_json(const LinkReport& report) {
  ordered_json object = {{"from", report.from}, {"to", report.to}};
  visit_counts(report, [&](const char* name, std::uint64_t count) { object[name] = count; });
  visit_times(report, [&](const char* name, Duration time) { object[name] = seconds(time); });
  return object;
}

LinkReport link_report_of(const ordered_json& object) {
  LinkReport report;
  report.from = object.at("from");
  report.to = object.at("to");
  visit_counts(report, [&](const char* name, std::uint64_t& count) { count = object.at(name); });
  visit_times(report, [&](const char* name, Duration& time) { time = from_seconds(object.at(name)); });
  return report;
}

std::vector<std::vector<std::string>> rows_of(const std::vector<LinkReport>& reports) {
  std::vector<std::vector<std::string>> rows = {{"link", "packets", "bytes", "delivered", "lost", "in bursts",
                                                 "queue full", "down", "twice", "out of order", "corrupted",
                                                 "mean delay", "late by"}};
  for (const LinkReport& report : reports) {
    const LinkCounters& counters = report.counters;
    if (counters.packets == 0) continue;
    const auto copies = counters.delivered + counters.duplicated;
    rows.push_back(
        {report.from + " > " + report.to, std::to_string(counters.packets), std::to_string(counters.bytes),
         decimal(100.0 * static_cast<double>(counters.delivered) / static_cast<double>(counters.packets), "%.1f %%"),
         std::to_string(counters.lost), std::to_string(counters.lost_in_burst), std::to_string(counters.queue_full),
         std::to_string(counters.down), std::to_string(counters.duplicated), std::to_string(counters.reordered),
         std::to_string(counters.corrupted), decimal(mean_ms(counters.total_delay, copies), "%.2f ms"),
         decimal(mean_ms(report.total_lateness, report.handed_over), "%.3f ms")});
  }
  return rows;
}

}  // namespace kervan::link
