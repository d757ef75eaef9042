#include "deploy/composition/clock_rules.hpp"

#include <algorithm>

namespace kervan::composition {
namespace {

constexpr const char* kClockTopic = "/clock";
constexpr const char* kClockType = "rosgraph_msgs::msg::Clock";

std::vector<PortReference> clock_writers(const ResolvedComposition& resolved) {
  std::vector<PortReference> writers;
  for (std::size_t c = 0; c < resolved.components.size(); ++c)
    for (std::size_t p = 0; p < resolved.components[c].ports.size(); ++p) {
      const ResolvedPort& port = resolved.components[c].ports[p];
      if (port.topic == kClockTopic && port.info.direction == PortDirection::output) writers.push_back({c, p});
    }
  return writers;
}

/// Hands the step to whoever takes it; what keeps it from that, or nothing.
std::string give_step(ResolvedComposition& resolved, const std::vector<PortReference>& writers, Duration step) {
  for (const PortReference writer : writers) {
    ResolvedComponent& component = resolved.components[writer.component];
    const auto info = std::ranges::find(component.manifest.parameters, "step", &ParameterInfo::name);
    if (info == component.manifest.parameters.end() || info->kind != ParameterKind::duration) continue;
    const auto given = component.parameters.find("step");
    if (given != component.parameters.end() && from_seconds(std::get<double>(given->second)) != step)
      return component.name + " has another step of its own; give it in one place";
    const ValueMap values{{"step", seconds(step)}};
    try {
      validate({*info}, values, false);
    } catch (const ParameterError& error) {
      return error.message();
    }
    component.parameters["step"] = seconds(step);
    return {};
  }
  return "no component here writes /clock and has a parameter 'step', so it means nothing; leave it out";
}

}  // namespace

void judge_clock(ResolvedComposition& resolved) {
  const Clock& clock = resolved.source.clock;
  const auto find = [&](Severity severity, const Location& at, const std::string& what) {
    resolved.findings.push_back({severity, at, what});
  };
  const std::vector<PortReference> writers = clock_writers(resolved);
  if (clock.step)
    if (const std::string why = give_step(resolved, writers, *clock.step); !why.empty())
      find(Severity::error, clock.step_location, "step: " + why);
  if (clock.mode != ClockMode::sim) return;
  if (writers.empty())
    find(Severity::error, clock.location,
         "clock sim needs a component that writes /clock, as sim/world does; add one, or write wall or lockstep");
  for (std::size_t i = 0; i < writers.size(); ++i) {
    const ResolvedPort& port = resolved.port(writers[i]);
    if (i > 0)
      find(Severity::error, port.location,
           "clock sim: both " + resolved.port_name(writers[0]) + " and " + resolved.port_name(writers[i]) +
               " write /clock; one component runs the time");
    else if (port.info.type != kClockType)
      find(Severity::error, port.location,
           "clock sim: " + resolved.port_name(writers[i]) + " writes /clock as " + port.info.type + ", not as " +
               kClockType);
  }
  if (clock.pace == 0.0 && resolved.source.containers.size() > 1)
    find(Severity::warning, clock.location,
         "pace max does not wait for other containers, so their answers may come late; write lockstep or a pace such "
         "as 4x");
}

}  // namespace kervan::composition
