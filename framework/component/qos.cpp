#include "framework/component/qos.hpp"

#include <chrono>

#include "framework/component/value.hpp"

namespace kervan {

using namespace std::chrono_literals;

const std::vector<QosProfile>& builtin_profiles() {
  static const std::vector<QosProfile> profiles{
      {.name = "sensor", .reliability = Reliability::best_effort, .deadline = 1s},
      {.name = "state"},
      {.name = "command", .deadline = 250ms, .lifespan = 250ms},
      {.name = "latched", .durability = Durability::transient_local},
      {.name = "event", .depth = 100},
  };
  return profiles;
}

std::optional<QosProfile> builtin_profile(std::string_view name) {
  for (const QosProfile& profile : builtin_profiles())
    if (profile.name == name) return profile;
  return std::nullopt;
}

std::string_view to_text(Reliability reliability) {
  return reliability == Reliability::reliable ? "reliable" : "best_effort";
}
std::string_view to_text(Durability durability) {
  return durability == Durability::transient_local ? "transient_local" : "volatile";
}
std::string_view to_text(Ownership ownership) { return ownership == Ownership::exclusive ? "exclusive" : "shared"; }
std::string_view to_text(Network network) { return network == Network::async ? "async" : "sync"; }
std::string_view to_text(Liveliness liveliness) { return liveliness == Liveliness::manual ? "manual" : "automatic"; }

std::string duration_text(Duration duration) {
  if (duration == forever) return "none";
  const double s = seconds(duration);
  if (s != 0.0 && s < 1.0 && s >= 1e-3) return to_text(Value(s * 1e3)) + " ms";
  if (s != 0.0 && s < 1e-3) return to_text(Value(s * 1e6)) + " us";
  return to_text(Value(s)) + " s";
}

std::string partition_text(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "[" : ", ") + name;
  return text.empty() ? "none" : text + "]";
}

}  // namespace kervan
