#include "deploy/composition/qos_rules.hpp"

#include <algorithm>

#include "deploy/composition/glob.hpp"

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
    {"durability",
     [](QosProfile& p, const Node& v) {
       p.durability = v.as_choice({"volatile", "transient_local"}) == "volatile" ? Durability::volatile_
                                                                                 : Durability::transient_local;
     },
     [](const QosProfile& p) { return std::string(to_text(p.durability)); }},
    {"depth", [](QosProfile& p, const Node& v) { p.depth = depth_or_all(v); },
     [](const QosProfile& p) { return p.depth == 0 ? std::string("all") : std::to_string(p.depth); }},
    {"deadline", [](QosProfile& p, const Node& v) { p.deadline = duration_or_none(v); },
     [](const QosProfile& p) { return duration_text(p.deadline); }},
    {"lifespan", [](QosProfile& p, const Node& v) { p.lifespan = duration_or_none(v); },
     [](const QosProfile& p) { return duration_text(p.lifespan); }},
    {"ownership",
     [](QosProfile& p, const Node& v) {
       p.ownership = v.as_choice({"shared", "exclusive"}) == "shared" ? Ownership::shared : Ownership::exclusive;
     },
     [](const QosProfile& p) { return std::string(to_text(p.ownership)); }},
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

void set_origin(EffectiveQos& qos, const Field& field, const std::string& origin) {
  for (QosValue& value : qos.values)
    if (value.name == field.name) value = {field.name, field.show(qos.profile), origin};
}

/// Puts the values that `settings` gives on top of `qos`.
void apply(EffectiveQos& qos, const Node& settings, const std::string& where) {
  for (const Field& field : fields) {
    const Node* value = settings.optional(field.name);
    if (value == nullptr) continue;
    field.set(qos.profile, *value);
    set_origin(qos, field, to_text(value->location) + " (" + where + ")");
  }
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
  const auto untouched = [&](const char* name) {
    const auto value =
        std::find_if(qos.values.begin(), qos.values.end(), [&](const QosValue& v) { return v.name == name; });
    return value->origin.starts_with("built-in") || value->origin.starts_with("profile");
  };
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
  if (entry) apply(qos, entry->settings, "topic " + entry->pattern);
  return qos;
}

void check_topic_settings(const Node& settings) {
  settings.only_keys(keys_with({"qos", "external"}));
  if (const Node* external = settings.optional("external")) external->as_bool();
  QosProfile scratch;
  for (const Field& field : fields)
    if (const Node* value = settings.optional(field.name)) field.set(scratch, *value);
}

}  // namespace kervan::composition
