#include "deploy/composition/rates.hpp"

#include <algorithm>
#include <optional>

namespace kervan::composition {
namespace {

/// The shortest period of a component, with the line it was written in: that of the parameter with this value, else the
/// component's own.
struct Period {
  Duration duration;
  Location location;
};

std::optional<Period> shortest_period(const ResolvedComponent& component, const ComponentEntry& entry) {
  const auto& timers = component.manifest.timers;
  if (timers.empty()) return std::nullopt;
  const auto shortest = std::ranges::min_element(timers, {}, &TimerInfo::period)->period;
  Period period{shortest, component.location};
  for (const ParameterInfo& info : component.manifest.parameters) {
    const auto given = component.parameters.find(info.name);
    if (info.kind != ParameterKind::duration || given == component.parameters.end()) continue;
    const auto* value = std::get_if<double>(&given->second);
    if (value == nullptr || from_seconds(*value) != shortest) continue;
    // One that the composition's clock gave stands at the clock, not here.
    if (const config::Node* written = entry.params.optional(info.name)) period.location = written->location;
  }
  return period;
}

}  // namespace

void check_rates(ResolvedComposition& resolved, const ResolvedTopic& topic) {
  const QosProfile& profile = topic.qos.profile;
  for (const PortReference writer : topic.writers) {
    const ResolvedComponent& component = resolved.components[writer.component];
    const auto period = shortest_period(component, resolved.source.components[writer.component]);
    if (!period) continue;
    const bool only_timers = std::ranges::all_of(
        component.ports, [](const ResolvedPort& port) { return port.info.direction == PortDirection::output; });
    const auto find = [&](Severity severity, const std::string& what) {
      resolved.findings.push_back({only_timers ? severity : Severity::warning, period->location,
                                   resolved.port_name(writer) + " is published every " +
                                       duration_text(period->duration) + ", but " + what +
                                       (only_timers ? "" : "; unless it also publishes when a sample arrives")});
    };
    const auto value = [&](const char* name) { return value_and_origin(topic.qos.value(name)); };
    if (profile.deadline < period->duration)
      find(Severity::error, "the deadline of '" + topic.name + "' is " + value("deadline") + ": each period misses it");
    if (profile.liveliness == Liveliness::manual && profile.lease < period->duration)
      find(Severity::error, "the lease of '" + topic.name + "' is " + value("lease") +
                                ": its writer counts as lost in between, unless it calls assert_alive()");
    if (profile.lifespan < period->duration)
      find(Severity::warning, "the lifespan of '" + topic.name + "' is " + value("lifespan") +
                                  ": a sample is over before the next one comes");
    for (const PortReference reader : topic.readers) {
      const Duration max_age = resolved.port(reader).info.qos.max_age();
      if (max_age < period->duration)
        find(Severity::warning, resolved.port_name(reader) + " accepts samples up to " + duration_text(max_age) +
                                    " old: it is without one in between");
    }
  }
}

}  // namespace kervan::composition
