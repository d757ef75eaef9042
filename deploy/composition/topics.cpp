#include "deploy/composition/topics.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace kervan::composition {
namespace {

using config::Node;

/// A topic name as DDS and ROS 2 take it: segments of letters, digits and _, none of which begins with a digit.
bool is_topic(const std::string& name) {
  if (name.size() < 2 || name[0] != '/') return false;
  char before = '\0';
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    if (c == '/' && before == '/') return false;
    if (c != '/' && c != '_' && !std::isalnum(u)) return false;
    if (std::isdigit(u) && before == '/') return false;
    before = c;
  }
  return before != '/';
}

std::string in_scope(const std::string& scope, const std::string& name) {
  if (name.starts_with('/')) return name;
  return (scope.empty() ? "/" : "/" + scope + "/") + name;
}

std::vector<std::string> port_names(const ResolvedComponent& component) {
  std::vector<std::string> names;
  for (const ResolvedPort& port : component.ports) names.push_back(port.info.name);
  return names;
}

/// Follows remaps; a port may be remapped to another's port that is remapped itself.
class TopicNames {
 public:
  explicit TopicNames(ResolvedComposition& resolved) : resolved_(resolved) {}

  void check_remaps() const {
    for (std::size_t c = 0; c < resolved_.components.size(); ++c) {
      const ResolvedComponent& component = resolved_.components[c];
      const auto names = port_names(component);
      for (const Node& remap : entry(c).remap.map())
        if (std::find(names.begin(), names.end(), remap.name) == names.end())
          remap.fail_at_key(component.manifest.type + " has no port '" + remap.name + "'" +
                            config::hint(remap.name, names, "it has"));
    }
  }

  const std::string& topic(std::size_t c, std::size_t p) {
    ResolvedPort& port = resolved_.components[c].ports[p];
    if (!port.topic.empty()) return port.topic;
    const Node* remap = entry(c).remap.optional(port.info.name);
    if (remap == nullptr) {
      port.topic = in_scope(entry(c).scope, port.info.name);
      if (!is_topic(port.topic))
        throw ConfigError(port.location, "'" + port.topic + "' is not a topic, so " + resolved_.port_name({c, p}) +
                                             " cannot be one; use names of letters, digits and _, no digit first");
      return port.topic;
    }
    if (!visiting_.insert({c, p}).second) remap->fail("this remap leads back to itself");
    port.location = remap->location;
    port.topic = target(*remap, entry(c).scope);
    visiting_.erase({c, p});
    return port.topic;
  }

 private:
  const ComponentEntry& entry(std::size_t c) const { return resolved_.source.components[c]; }

  std::string target(const Node& remap, const std::string& scope) {
    const std::string value = remap.as_text();
    if (!value.starts_with('/'))
      if (const auto port = port_of(remap, scope, value)) return topic(port->component, port->port);
    const std::string name = in_scope(scope, value);
    if (!is_topic(name))
      remap.fail(remap.shown() + " is not a topic; use letters, digits and _ between slashes, or component/port");
    return name;
  }

  /// The port that `component/port` names. Port names may hold slashes too, so the longest component name decides.
  std::optional<PortReference> port_of(const Node& remap, const std::string& scope, const std::string& value) const {
    for (std::size_t slash = value.rfind('/'); slash != std::string::npos && slash > 0;
         slash = value.rfind('/', slash - 1)) {
      const std::string name = (scope.empty() ? "" : scope + "/") + value.substr(0, slash);
      for (std::size_t c = 0; c < resolved_.components.size(); ++c) {
        if (resolved_.components[c].name != name) continue;
        const std::string port = value.substr(slash + 1);
        const auto names = port_names(resolved_.components[c]);
        const auto found = std::find(names.begin(), names.end(), port);
        if (found != names.end()) return PortReference{c, static_cast<std::size_t>(found - names.begin())};
        remap.fail("the component '" + name + "' has no port '" + port + "'" + config::hint(port, names, "it has"));
      }
    }
    return std::nullopt;
  }

  ResolvedComposition& resolved_;
  std::set<std::pair<std::size_t, std::size_t>> visiting_;
};

}  // namespace

void name_topics(ResolvedComposition& resolved) {
  TopicNames names(resolved);
  names.check_remaps();
  for (std::size_t c = 0; c < resolved.components.size(); ++c)
    for (std::size_t p = 0; p < resolved.components[c].ports.size(); ++p) names.topic(c, p);
}

}  // namespace kervan::composition
