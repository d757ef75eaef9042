#include "deploy/composition/qos_rules.hpp"

#include <algorithm>
#include <cctype>

#include "deploy/composition/glob.hpp"
#include "framework/component/qos_match.hpp"

namespace kervan::composition {
namespace {

using config::Node;

Duration duration_or_none(const Node& node) {
  if (node.is_scalar() && !node.quoted && node.text == "none") return forever;
  const Duration duration = node.as_duration();
  if (duration <= Duration::zero()) node.fail(node.shown() + " is out of range; allowed: more than 0 s, or none");
  return duration;
}

int depth_or_all(const Node& node) {
  if (node.is_scalar() && !node.quoted && node.text == "all") return 0;
  const std::int64_t depth = node.as_integer();
  if (depth < 1 || depth > 100'000) node.fail(node.shown() + " is out of range; allowed: 1 .. 100000, or all");
  return static_cast<int>(depth);
}

/// Names of partitions, or patterns with * and ?, as a list or a single one; none takes back what a base gave.
std::vector<std::string> partition_or_none(const Node& node) {
  if (node.is_scalar() && !node.quoted && node.text == "none") return {};
  std::vector<std::string> names;
  const auto add = [&](const Node& item) {
    const std::string name = item.as_text();
    const auto allowed = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
             std::string_view("_-./*?").find(c) != std::string::npos;
    };
    if (name.empty() || name.size() > 200 || !std::all_of(name.begin(), name.end(), allowed))
      item.fail(item.shown() +
                " is not the name of a partition; use letters, digits, _ - . / and the wildcards * and ?");
    if (std::find(names.begin(), names.end(), name) != names.end()) item.fail("'" + name + "' is named twice");
    names.push_back(name);
  };
  if (node.is_scalar())
    add(node);
  else
    for (const Node& item : node.list()) add(item);
  if (names.empty()) node.fail("a partition needs a name; write none for no partition");
  return names;
}

int limit_or_none(const Node& node) {
  if (node.is_scalar() && !node.quoted && node.text == "none") return 0;
  const std::int64_t limit = node.as_integer();
  if (limit < 1 || limit > 100'000) node.fail(node.shown() + " is out of range; allowed: 1 .. 100000, or none");
  return static_cast<int>(limit);
}

Durability durability(const Node& node) {
  const std::string word = node.as_text();
  if (word == "transient" || word == "persistent")
    node.fail("Cyclone DDS accepts " + word +
              " and keeps nothing: a late joiner gets no sample; write transient_local, and let a component that "
              "outlives the writer (a keeper) store the samples and publish them again");
  return node.as_choice({"volatile", "transient_local"}) == "volatile" ? Durability::volatile_
                                                                       : Durability::transient_local;
}

Liveliness liveliness(const Node& node) {
  const std::string word = node.as_text();
  if (word == "manual_by_topic" || word == "manual_by_participant")
    node.fail("write manual: each writer says for itself that it is alive, as with manual_by_topic of DDS");
  return node.as_choice({"automatic", "manual"}) == "manual" ? Liveliness::manual : Liveliness::automatic;
}

/// What DDS knows and Kervan does not offer, with what to write instead.
struct Refused {
  const char* key;
  const char* reason;
};

constexpr const char* kNoFilter =
    "Cyclone DDS accepts a time-based filter and ignores it: every sample would still come; let the component look at "
    "the latest sample from a timer of its own, or let the writer publish less often";
constexpr const char* kNoLimits =
    "a reader of Cyclone DDS that is full makes its writer wait; write limit, the most samples that wait in one input "
    "(with depth: all)";
constexpr const char* kNoSets =
    "Cyclone DDS refuses coherent and ordered sets; put what belongs together into one message";

const Refused refused[] = {
    {"time_based_filter", kNoFilter},
    {"minimum_separation", kNoFilter},
    {"history", "write depth: a number to keep the last, or all"},
    {"resource_limits", kNoLimits},
    {"max_samples", kNoLimits},
    {"max_instances", kNoLimits},
    {"max_samples_per_instance", kNoLimits},
    {"max_blocking", "no writer ever waits for a reader; leave it out"},
    {"max_blocking_time", "no writer ever waits for a reader; leave it out"},
    {"transport_priority", "Cyclone DDS accepts a transport priority and ignores it; leave it out"},
    {"latency_budget", "write network: async to let Cyclone DDS send in a thread of its own, or sync"},
    {"destination_order", "samples are in the order of writer, then sequence, everywhere; leave it out"},
    {"presentation", kNoSets},
    {"coherent_access", kNoSets},
    {"ordered_access", kNoSets},
    {"strength", "a strength belongs to a writer, not to the topic; give it to the component: strength: {PORT: 5}"},
    {"ownership_strength",
     "a strength belongs to a writer, not to the topic; give it to the component: strength: {PORT: 5}"},
    {"durability_service", "a late joiner gets as many samples as depth says; leave it out"},
    {"lease_duration", "write lease"},
    {"liveliness_lease_duration", "write lease"},
    {"max_age", "the largest age is what an input requires, and its component declares it; a topic has a lifespan"},
};

void refuse_what_dds_ignores(const Node& settings) {
  for (const Node& given : settings.map())
    for (const Refused& one : refused)
      if (given.name == one.key) given.fail_at_key("'" + given.name + "': " + one.reason);
}

/// One value of a profile: how it is read from a file and how it is shown.
struct Field {
  const char* name;
  void (*set)(QosProfile& profile, const Node& value);
  std::string (*show)(const QosProfile& profile);
};

const Field fields[] = {
    {"reliability",
     [](QosProfile& p, const Node& v) {
       p.reliability =
           v.as_choice({"reliable", "best_effort"}) == "reliable" ? Reliability::reliable : Reliability::best_effort;
     },
     [](const QosProfile& p) { return std::string(to_text(p.reliability)); }},
    {"durability", [](QosProfile& p, const Node& v) { p.durability = durability(v); },
     [](const QosProfile& p) { return std::string(to_text(p.durability)); }},
    {"depth", [](QosProfile& p, const Node& v) { p.depth = depth_or_all(v); },
     [](const QosProfile& p) { return p.depth == 0 ? std::string("all") : std::to_string(p.depth); }},
    {"limit", [](QosProfile& p, const Node& v) { p.limit = limit_or_none(v); },
     [](const QosProfile& p) { return p.limit == 0 ? std::string("none") : std::to_string(p.limit); }},
    {"deadline", [](QosProfile& p, const Node& v) { p.deadline = duration_or_none(v); },
     [](const QosProfile& p) { return duration_text(p.deadline); }},
    {"lifespan", [](QosProfile& p, const Node& v) { p.lifespan = duration_or_none(v); },
     [](const QosProfile& p) { return duration_text(p.lifespan); }},
    {"liveliness", [](QosProfile& p, const Node& v) { p.liveliness = liveliness(v); },
     [](const QosProfile& p) { return std::string(to_text(p.liveliness)); }},
    {"lease", [](QosProfile& p, const Node& v) { p.lease = duration_or_none(v); },
     [](const QosProfile& p) { return duration_text(p.lease); }},
    {"ownership",
     [](QosProfile& p, const Node& v) {
       p.ownership = v.as_choice({"shared", "exclusive"}) == "shared" ? Ownership::shared : Ownership::exclusive;
     },
     [](const QosProfile& p) { return std::string(to_text(p.ownership)); }},
    {"partition", [](QosProfile& p, const Node& v) { p.partition = partition_or_none(v); },
     [](const QosProfile& p) { return partition_text(p.partition); }},
    {"network",
     [](QosProfile& p, const Node& v) {
       p.network = v.as_choice({"sync", "async"}) == "sync" ? Network::sync : Network::async;
     },
     [](const QosProfile& p) { return std::string(to_text(p.network)); }},
    {"trace", [](QosProfile& p, const Node& v) { p.trace = v.as_bool(); },
     [](const QosProfile& p) { return std::string(p.trace ? "true" : "false"); }},
};

std::vector<std::string> keys_with(std::vector<std::string> keys) {
  for (const Field& field : fields) keys.emplace_back(field.name);
  return keys;
}

void set_origin(EffectiveQos& qos, const Field& field, const std::string& origin, const Location& location = {}) {
  for (QosValue& value : qos.values)
    if (value.name == field.name) value = {field.name, field.show(qos.profile), origin, location};
}

/// Puts the values that `settings` gives on top of `qos`.
void apply(EffectiveQos& qos, const Node& settings, const std::string& where) {
  for (const Field& field : fields) {
    const Node* value = settings.optional(field.name);
    if (value == nullptr) continue;
    field.set(qos.profile, *value);
    set_origin(qos, field, to_text(value->location) + " (" + where + ")", value->location);
  }
}

/// Values that exclude each other; which one is named decides where the error points.
void require_consistent(const EffectiveQos& qos, const Node& settings) {
  const QosProfile& profile = qos.profile;
  const auto fail = [&](const char* name, const std::string& message) {
    const QosValue& value = qos.value(name);
    throw ConfigError(value.location.line > 0 ? value.location : settings.key_location,
                      std::string(name) + ": " + message);
  };
  if (profile.liveliness == Liveliness::manual && profile.lease == forever)
    fail("liveliness", "manual needs a lease, the longest time between two signs of life; write e.g. lease: 1 s");
  if (profile.limit > 0 && profile.depth > 0)
    fail("limit", "a limit goes with depth: all; with depth " + std::to_string(profile.depth) + " (from " +
                      qos.value("depth").origin + ") each key keeps so many anyway");
  if (profile.durability == Durability::transient_local && profile.reliability == Reliability::best_effort)
    fail("durability", "transient_local needs reliability: reliable (it is best_effort, from " +
                           qos.value("reliability").origin +
                           "): Cyclone DDS accepts it, and a best-effort reader gets no old samples");
  if (!partitions_meet(profile.partition, profile.partition))
    fail("partition", partition_text(profile.partition) +
                          " would keep the topic's own writers and readers apart: all have this list, and a pattern "
                          "meets plain names only; name at least one partition in full");
}

EffectiveQos all_from(const QosProfile& profile, const std::string& origin) {
  EffectiveQos qos{profile, {}};
  for (const Field& field : fields) qos.values.push_back({field.name, field.show(profile), origin});
  return qos;
}

}  // namespace

Profiles::Profiles(const std::vector<ProfileEntry>& entries) {
  for (const QosProfile& profile : builtin_profiles())
    profiles_[profile.name] = all_from(profile, "built-in profile " + profile.name);
  for (const ProfileEntry& entry : entries)
    if (builtin_profile(entry.name))
      entry.settings.fail_at_key("'" + entry.name +
                                 "' is a built-in profile; give yours another name and write 'extends: " + entry.name +
                                 "'");
  for (const ProfileEntry& entry : entries) {
    std::vector<std::string> path;
    build(entry, entries, path);
  }
}

const EffectiveQos& Profiles::build(const ProfileEntry& entry, const std::vector<ProfileEntry>& entries,
                                    std::vector<std::string>& path) {
  if (const auto found = profiles_.find(entry.name); found != profiles_.end()) return found->second;
  path.push_back(entry.name);
  refuse_what_dds_ignores(entry.settings);
  entry.settings.only_keys(keys_with({"extends"}));
  EffectiveQos qos;
  const Node* extends = entry.settings.optional("extends");
  const std::string base = extends ? extends->as_text() : "state";
  if (const EffectiveQos* known = find(base)) {
    qos = *known;
  } else {
    std::vector<std::string> all = names();
    for (const ProfileEntry& other : entries)
      if (std::find(all.begin(), all.end(), other.name) == all.end() && other.name != entry.name)
        all.push_back(other.name);
    const auto next =
        std::find_if(entries.begin(), entries.end(), [&](const ProfileEntry& e) { return e.name == base; });
    if (std::find(path.begin(), path.end(), base) != path.end())
      extends->fail("the profile '" + base + "' extends itself");
    if (next == entries.end())
      extends->fail("there is no profile '" + base + "'" + config::hint(base, all, "there are"));
    qos = build(*next, entries, path);
  }
  qos.profile.name = entry.name;
  apply(qos, entry.settings, "profile " + entry.name);
  require_consistent(qos, entry.settings);
  return profiles_[entry.name] = std::move(qos);
}

const EffectiveQos* Profiles::find(const std::string& name) const {
  const auto found = profiles_.find(name);
  return found == profiles_.end() ? nullptr : &found->second;
}

std::vector<std::string> Profiles::names() const {
  std::vector<std::string> names;
  for (const auto& [name, profile] : profiles_) names.push_back(name);
  return names;
}

const TopicEntry* entry_for(const std::string& topic, const std::vector<TopicEntry>& entries) {
  const TopicEntry* best = nullptr;
  const TopicEntry* equal = nullptr;
  for (const TopicEntry& entry : entries) {
    if (!matches(entry.pattern, topic)) continue;
    if (best == nullptr || more_specific(entry.pattern, best->pattern)) {
      best = &entry;
      equal = nullptr;
    } else if (!more_specific(best->pattern, entry.pattern)) {
      equal = &entry;
    }
  }
  if (equal != nullptr)
    equal->settings.fail_at_key("'" + equal->pattern + "' and '" + best->pattern + "' (" +
                                to_text(best->settings.key_location) + ") fit '" + topic +
                                "' equally well; add an entry for '" + topic + "' itself");
  return best;
}

EffectiveQos effective_qos(const TopicFacts& topic, const TopicEntry* entry, const Profiles& profiles) {
  const Node* named = entry ? entry->settings.optional("qos") : nullptr;
  EffectiveQos qos;
  if (named != nullptr) {
    const std::string name = named->as_text();
    const EffectiveQos* found = profiles.find(name);
    const auto names = profiles.names();
    if (found == nullptr) named->fail("there is no profile '" + name + "'" + config::hint(name, names, "there are"));
    qos = *found;
  } else {
    const auto declared = builtin_profile(topic.declared_profile);
    qos = all_from(declared.value_or(QosProfile{}), "profile " + topic.declared_profile + ", " + topic.declared_by);
  }
  const auto untouched = [&](const char* name) { return qos.value(name).location.line == 0; };
  for (const Field& field : fields) {
    if (field.name == std::string_view("network") && topic.own_type && untouched("network")) {
      qos.profile.network = Network::async;
      set_origin(qos, field, "default for kervan_msgs");
    }
    if (field.name == std::string_view("trace") && topic.untraced && untouched("trace")) {
      qos.profile.trace = false;
      set_origin(qos, field, "declared by its port");
    }
  }
  if (entry) {
    apply(qos, entry->settings, "topic " + entry->pattern);
    require_consistent(qos, entry->settings);
  }
  return qos;
}

std::string value_and_origin(const QosValue& value) { return value.value + ", from " + value.origin; }

const QosValue& EffectiveQos::value(std::string_view name) const {
  return *std::find_if(values.begin(), values.end(), [&](const QosValue& value) { return value.name == name; });
}

void check_topic_settings(const Node& settings) {
  refuse_what_dds_ignores(settings);
  settings.only_keys(keys_with({"qos", "external"}));
  if (const Node* external = settings.optional("external")) external->as_bool();
  QosProfile scratch;
  for (const Field& field : fields)
    if (const Node* value = settings.optional(field.name)) field.set(scratch, *value);
}

}  // namespace kervan::composition
