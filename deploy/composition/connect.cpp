#include <algorithm>
#include <set>
#include <tuple>

#include "deploy/composition/glob.hpp"
#include "deploy/composition/rates.hpp"
#include "deploy/composition/topics.hpp"
#include "framework/component/qos_match.hpp"

namespace kervan::composition {
namespace {

using config::Node;

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
    }
    for (const auto& [name, topic] : resolved_.topics) {
      check_profile(topic);
      check_rates(resolved_, topic);
      if (topic.writers.empty()) check_missing_writer(topic);
      if (topic.readers.empty()) note_unread(topic);
      for (const PortReference reader : topic.readers) judge_reader(topic, reader);
    }
    report_missing_writers();
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

  /// "did you mean": another topic of the same type, with almost this name, that lacks just what this one has.
  std::string other_half(const ResolvedTopic& topic) const {
    std::vector<std::string> names;
    for (const auto& [name, other] : resolved_.topics)
      if (other.type == topic.type && other.writers.empty() == topic.readers.empty() &&
          other.readers.empty() == topic.writers.empty())
        names.push_back(name);
    return config::did_you_mean(topic.name, names);
  }

  /// A topic that nothing writes. Whether that is wrong depends on who reads it.
  void check_missing_writer(const ResolvedTopic& topic) {
    const bool external = is_external(topic);
    for (const PortReference reader : topic.readers) {
      resolved_.pairs.push_back({topic.name, topic.type, "", resolved_.port_name(reader), topic.qos.profile.name,
                                 external                         ? "written from outside"
                                 : info(reader).qos.is_optional() ? "nothing writes it; optional"
                                                                  : "nothing writes it"});
      if (external) continue;
      if (!info(reader).qos.is_optional())
        unwritten_.push_back(reader);
      else if (const std::string hint = other_half(topic); !hint.empty())
        find(Severity::warning, reader,
             "nothing writes '" + topic.name + "', which " + resolved_.port_name(reader) + " could read" + hint);
    }
  }

  void note_unread(const ResolvedTopic& topic) {
    for (const PortReference writer : topic.writers)
      resolved_.pairs.push_back({topic.name, topic.type, resolved_.port_name(writer), "", topic.qos.profile.name,
                                 "nobody reads it" + other_half(topic)});
  }

  /// One finding a cause: several inputs that are there because of one line (`goals: {r2: …}`) miss their writers
  /// together if that line names something that does not exist.
  void report_missing_writers() {
    while (!unwritten_.empty()) {
      const PortReference first = unwritten_.front();
      std::vector<PortReference> together;
      for (const PortReference port : unwritten_)
        if (port.component == first.component &&
            same_place(resolved_.port(port).location, resolved_.port(first).location) &&
            scope_of(port) == scope_of(first) && !scope_of(first).empty())
          together.push_back(port);
      if (together.size() > 1)
        report_missing_scope(together);
      else
        report_missing(first);
      std::erase_if(unwritten_, [&](const PortReference port) {
        return port == first ||
               (together.size() > 1 && std::find(together.begin(), together.end(), port) != together.end());
      });
    }
  }

  void report_missing(PortReference reader) {
    const ResolvedTopic& topic = resolved_.topics.at(resolved_.port(reader).topic);
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

  void report_missing_scope(const std::vector<PortReference>& ports) {
    const std::string scope = scope_of(ports.front());
    std::vector<std::string> missing;
    for (const PortReference port : ports) missing.push_back(resolved_.port(port).topic);
    std::set<std::string> known;
    for (const auto& [name, topic] : resolved_.topics) {
      if (topic.writers.empty() || topic.type != info(ports.front()).type) continue;
      const std::size_t slash = name.find('/', 1);
      if (slash != std::string::npos) known.insert(name.substr(1, slash - 1));
    }
    const std::vector<std::string> names(known.begin(), known.end());
    find(Severity::error, ports.front(),
         "there is no '" + scope + "' for " + resolved_.components[ports.front().component].name + ": nothing writes " +
             config::joined(missing) + "; there are: " + config::joined(names));
  }

  /// "r2" of the port "r2/truth"; empty for a port of the component itself.
  std::string scope_of(PortReference port) const {
    const std::string& name = info(port).name;
    const std::size_t slash = name.find('/');
    return slash == std::string::npos || slash == 0 ? "" : name.substr(0, slash);
  }

  static bool same_place(const Location& a, const Location& b) {
    return a.file == b.file && a.line == b.line && a.column == b.column;
  }

  /// What of a profile is odd whoever reads the topic.
  void check_profile(const ResolvedTopic& topic) {
    const QosProfile& profile = topic.qos.profile;
    const PortReference port = topic.writers.empty() ? topic.readers.front() : topic.writers.front();
    if (profile.depth == 0 && profile.limit == 0)
      find_value(Severity::warning, topic, "depth", port,
                 "the topic '" + topic.name + "' keeps all samples (depth " + given_value(topic, "depth") +
                     ") without a limit: of each key " + std::to_string(kMostKept) +
                     " wait for an input that is not emptied, then the oldest go; add e.g. limit: 1000");
    if (profile.ownership == Ownership::shared)
      for (const PortReference writer : topic.writers)
        if (const ResolvedPort& output = resolved_.port(writer); output.strength)
          resolved_.findings.push_back({Severity::warning, output.strength_location,
                                        "the strength of " + resolved_.port_name(writer) +
                                            " has no effect: the ownership of '" + topic.name + "' is " +
                                            given_value(topic, "ownership")});
  }

  /// A finding at the line that gave a value of the topic's profile, or at the port if none did.
  void find_value(Severity severity, const ResolvedTopic& topic, std::string_view value, PortReference port,
                  const std::string& message) {
    const Location& at = topic.qos.value(value).location;
    resolved_.findings.push_back({severity, at.line > 0 ? at : resolved_.port(port).location, message});
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

  static std::string given_value(const ResolvedTopic& topic, std::string_view name) {
    return value_and_origin(topic.qos.value(name));
  }

  /// What the reader requires of the topic's profile and does not get; empty if all is well. The quality of service of
  /// another type's topic says nothing, and the type is reported already.
  std::pair<Severity, std::string> requirement(const ResolvedTopic& topic, PortReference reader) const {
    if (info(reader).type != topic.type) return {Severity::warning, ""};
    const PortQos& wanted = info(reader).qos;
    const QosProfile& given = topic.qos.profile;
    if (wanted.max_age() != forever && given.durability == Durability::transient_local)
      return {Severity::error, "it accepts samples up to " + duration_text(wanted.max_age()) +
                                   " old, but on a transient local topic (" + given_value(topic, "durability") +
                                   ") an old sample looks fresh to a late joiner"};
    for (const QosConflict& conflict : qos_conflicts(offered_qos(given), required_qos(given, wanted)))
      switch (conflict.policy) {
        case QosPolicy::deadline:
          return {Severity::error, "it requires a deadline of " + duration_text(wanted.deadline()) +
                                       " or shorter, but the topic's is " + given_value(topic, "deadline")};
        case QosPolicy::liveliness:
          return {Severity::error, "it requires a lease of " + duration_text(wanted.lease()) +
                                       " or shorter, but the topic's is " + given_value(topic, "lease")};
        case QosPolicy::durability:
          return {Severity::error, "it requires durability transient_local, but the topic's is " +
                                       given_value(topic, "durability") +
                                       ": a sample from before it started would never arrive"};
        case QosPolicy::reliability:
          return {Severity::error,
                  "it must not lose samples, but the topic's reliability is " + given_value(topic, "reliability")};
        default: return {Severity::error, conflict.sentence};
      }
    const QosProfile declared = builtin_profile(wanted.profile()).value_or(QosProfile{});
    if (declared.reliability == Reliability::reliable && given.reliability == Reliability::best_effort)
      return {Severity::warning, "it expects a reliable topic, but its reliability is " +
                                     given_value(topic, "reliability") + ": samples may be lost"};
    return {Severity::warning, ""};
  }

  ResolvedComposition& resolved_;
  const ResolveOptions& options_;
  Profiles profiles_;
  std::vector<PortReference> unwritten_;  ///< inputs that need a writer and have none
};

}  // namespace

void connect(ResolvedComposition& resolved, const ResolveOptions& options) {
  Judge(resolved, options).run();
  std::stable_sort(resolved.findings.begin(), resolved.findings.end(), [](const Finding& a, const Finding& b) {
    return std::tie(a.location.line, a.location.column) < std::tie(b.location.line, b.location.column);
  });
}

}  // namespace kervan::composition
