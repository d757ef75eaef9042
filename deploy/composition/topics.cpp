#include "deploy/composition/topics.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <tuple>

#include "deploy/composition/glob.hpp"

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

/// Judges the topics once they are all known.
class Judge {
 public:
  Judge(ResolvedComposition& resolved, const ResolveOptions& options)
      : resolved_(resolved), options_(options), profiles_(resolved.source.profiles) {}

  void run() {
    collect();
    check_entries();
    for (auto& [name, topic] : resolved_.topics) {
      check_types(topic);
      choose_qos(topic);
      if (topic.writers.empty()) check_missing_writer(topic);
      for (const PortReference reader : topic.readers) judge_reader(topic, reader);
    }
  }

 private:
  const PortInfo& info(PortReference reference) const { return resolved_.port(reference).info; }

  void collect() {
    for (std::size_t c = 0; c < resolved_.components.size(); ++c) {
      for (std::size_t p = 0; p < resolved_.components[c].ports.size(); ++p) {
        const ResolvedPort& port = resolved_.components[c].ports[p];
        ResolvedTopic& topic = resolved_.topics[port.topic];
        topic.name = port.topic;
        (port.info.direction == PortDirection::output ? topic.writers : topic.readers).push_back({c, p});
      }
    }
    for (auto& [name, topic] : resolved_.topics) {
      const PortInfo& first = info(topic.writers.empty() ? topic.readers.front() : topic.writers.front());
      topic.type = first.type;
      topic.layout_hash = first.layout_hash;
    }
  }

  std::vector<std::string> topic_names() const {
    std::vector<std::string> names;
    for (const auto& [name, topic] : resolved_.topics) names.push_back(name);
    return names;
  }

  void check_entries() const {
    const auto names = topic_names();
    for (const TopicEntry& entry : resolved_.source.topics) {
      if (std::any_of(names.begin(), names.end(),
                      [&](const std::string& name) { return matches(entry.pattern, name); }))
        continue;
      entry.settings.fail_at_key(is_pattern(entry.pattern)
                                     ? "no topic fits '" + entry.pattern + "'; there are: " + config::joined(names)
                                     : "there is no topic '" + entry.pattern + "'" +
                                           config::hint(entry.pattern, names, "there are"));
    }
  }

  void find(Severity severity, PortReference at, const std::string& message) {
    resolved_.findings.push_back({severity, resolved_.port(at).location, message});
  }

  /// "is written by world.r1/sonar (lab.yaml:12:3) as sensor_msgs::msg::Range"
  std::string described(PortReference reference) const {
    return (info(reference).direction == PortDirection::output ? "written by " : "read by ") +
           resolved_.port_name(reference) + " (" + to_text(resolved_.port(reference).location) + ")";
  }

  void check_types(const ResolvedTopic& topic) {
    std::vector<PortReference> ports = topic.writers;
    ports.insert(ports.end(), topic.readers.begin(), topic.readers.end());
    const PortReference first = ports.front();
    for (const PortReference other : ports) {
      if (info(other).type != topic.type)
        find(Severity::error, other,
             "the topic '" + topic.name + "' is " + described(first) + " as " + topic.type + ", but " +
                 described(other) + " as " + info(other).type);
      else if (info(other).layout_hash != topic.layout_hash)
        find(Severity::error, other,
             "the topic '" + topic.name + "' is " + described(first) + " and " + described(other) +
                 " with two layouts of " + topic.type + "; build both against the same IDL");
    }
  }

  void choose_qos(ResolvedTopic& topic) {
    const auto& deciding = topic.writers.empty() ? topic.readers : topic.writers;
    const TopicEntry* entry = entry_for(topic.name, resolved_.source.topics);
    TopicFacts facts;
    facts.name = topic.name;
    facts.declared_profile = info(deciding.front()).qos.profile();
    facts.declared_by = "declared by " + resolved_.port_name(deciding.front());
    facts.own_type = topic.type.starts_with("kervan_msgs::");
    for (const PortReference writer : topic.writers) facts.untraced = facts.untraced || !info(writer).qos.traced();
    if (entry == nullptr || entry->settings.optional("qos") == nullptr)
      for (const PortReference other : deciding)
        if (info(other).type == topic.type && std::string_view(info(other).qos.profile()) != facts.declared_profile)
          find(Severity::error, other,
               "the topic '" + topic.name + "' is " + described(deciding.front()) + " with profile " +
                   facts.declared_profile + " and " + described(other) + " with profile " + info(other).qos.profile() +
                   "; choose one under 'topics'");
    topic.qos = effective_qos(facts, entry, profiles_);
  }

  bool is_external(const ResolvedTopic& topic) const {
    const auto& known = options_.external_topics;
    if (std::find(known.begin(), known.end(), topic.name) != known.end()) return true;
    const TopicEntry* entry = entry_for(topic.name, resolved_.source.topics);
    const Node* external = entry ? entry->settings.optional("external") : nullptr;
    return external && external->as_bool();
  }

  void check_missing_writer(const ResolvedTopic& topic) {
    if (is_external(topic)) return;
    for (const PortReference reader : topic.readers) {
      if (info(reader).qos.is_optional()) continue;
      std::vector<std::string> written, same_type;
      for (const auto& [name, other] : resolved_.topics) {
        if (other.writers.empty()) continue;
        written.push_back(name);
        if (other.type == topic.type) same_type.push_back(name);
      }
      std::string hint = config::did_you_mean(topic.name, same_type);
      if (hint.empty()) hint = config::did_you_mean(topic.name, written);
      if (hint.empty() && !same_type.empty()) hint = "; written with its type: " + config::joined(same_type);
      find(Severity::error, reader,
           "nothing writes '" + topic.name + "', which " + resolved_.port_name(reader) + " needs" + hint);
    }
  }

  void judge_reader(const ResolvedTopic& topic, PortReference reader) {
    const auto [severity, verdict] = requirement(topic, reader);
    if (!verdict.empty()) {
      std::string message = resolved_.port_name(reader) + " on '" + topic.name + "': " + verdict;
      find(severity, reader, message);
    }
    for (const PortReference writer : topic.writers) {
      const bool types_agree =
          info(writer).type == info(reader).type && info(writer).layout_hash == info(reader).layout_hash;
      resolved_.pairs.push_back({topic.name, info(writer).type, resolved_.port_name(writer),
                                 resolved_.port_name(reader), topic.qos.profile.name,
                                 !types_agree      ? "reads another type: " + info(reader).type
                                 : verdict.empty() ? "ok"
                                                   : verdict});
    }
  }

  /// "1 s (lab.yaml:5:20 (topic /raw))": a value of the topic's profile and the line that gave it.
  static std::string given_value(const ResolvedTopic& topic, std::string_view name) {
    for (const QosValue& value : topic.qos.values)
      if (value.name == name) return value.value + ", from " + value.origin;
    return "";
  }

  /// What the reader requires of the topic's profile and does not get; empty if all is well. The quality of service of
  /// another type's topic says nothing, and the type is reported already.
  std::pair<Severity, std::string> requirement(const ResolvedTopic& topic, PortReference reader) const {
    if (info(reader).type != topic.type) return {Severity::warning, ""};
    const PortQos& wanted = info(reader).qos;
    const QosProfile& given = topic.qos.profile;
    const QosProfile declared = builtin_profile(wanted.profile()).value_or(QosProfile{});
    if (wanted.max_age() != forever && given.durability == Durability::transient_local)
      return {Severity::error, "it accepts samples up to " + duration_text(wanted.max_age()) +
                                   " old, but on a transient local topic (" + given_value(topic, "durability") +
                                   ") an old sample looks fresh to a late joiner"};
    if (wanted.deadline() != forever && given.deadline > wanted.deadline())
      return {Severity::error, "it requires a deadline of " + duration_text(wanted.deadline()) +
                                   " or shorter, but the topic's is " + given_value(topic, "deadline")};
    if (declared.durability == Durability::transient_local && given.durability == Durability::volatile_)
      return {Severity::error, "it requires durability transient_local, but the topic's is " +
                                   given_value(topic, "durability") +
                                   ": a sample from before it started would never arrive"};
    if (declared.reliability == Reliability::reliable && given.reliability == Reliability::best_effort)
      return {Severity::warning, "it expects a reliable topic, but its reliability is " +
                                     given_value(topic, "reliability") + ": samples may be lost"};
    if (given.depth == 0 && !resolved_.components[reader.component].manifest.own_thread)
      return {Severity::warning, "the topic keeps all samples (depth " + given_value(topic, "depth") +
                                     "): while this component is stopped, its writers can be held up"};
    return {Severity::warning, ""};
  }

  ResolvedComposition& resolved_;
  const ResolveOptions& options_;
  Profiles profiles_;
};

}  // namespace

void name_topics(ResolvedComposition& resolved) {
  TopicNames names(resolved);
  names.check_remaps();
  for (std::size_t c = 0; c < resolved.components.size(); ++c)
    for (std::size_t p = 0; p < resolved.components[c].ports.size(); ++p) names.topic(c, p);
}

void connect(ResolvedComposition& resolved, const ResolveOptions& options) {
  Judge(resolved, options).run();
  std::stable_sort(resolved.findings.begin(), resolved.findings.end(), [](const Finding& a, const Finding& b) {
    return std::tie(a.location.line, a.location.column) < std::tie(b.location.line, b.location.column);
  });
}

}  // namespace kervan::composition
