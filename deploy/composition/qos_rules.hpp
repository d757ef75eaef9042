/// Quality of service as a composition states it: named profiles under `qos:`, and what `topics:` says of single topics
/// or patterns of them. Every value of an effective profile knows the line it came from.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "deploy/composition/composition.hpp"
#include "framework/component/qos.hpp"

namespace kervan::composition {

/// One value of an effective profile: `deadline`, `400 ms`, `lab.yaml:17:30 (profile radio)`.
struct QosValue {
  std::string name;
  std::string value;
  std::string origin;
  Location location = {};  ///< unknown for a value that no line of the file gave
};

struct EffectiveQos {
  QosProfile profile;
  std::vector<QosValue> values;  ///< in a fixed order, one for each value of the profile

  const QosValue& value(std::string_view name) const;  ///< of the profile, which has it
};

/// The built-in profiles and a composition's own, with `extends` followed.
class Profiles {
 public:
  /// Throws ConfigError for unknown keys, wrong values, values that exclude each other, unknown bases, circles, and
  /// names that are built in.
  explicit Profiles(const std::vector<ProfileEntry>& entries);

  /// nullptr if there is none.
  const EffectiveQos* find(const std::string& name) const;
  std::vector<std::string> names() const;

 private:
  const EffectiveQos& build(const ProfileEntry& entry, const std::vector<ProfileEntry>& entries,
                            std::vector<std::string>& path);

  std::map<std::string, EffectiveQos> profiles_;
};

/// What one topic's ports and type say of it.
struct TopicFacts {
  std::string name;              ///< absolute
  std::string declared_profile;  ///< of its writers, or of its readers if nothing writes it
  std::string declared_by;       ///< "written by world.r1/sonar"
  bool own_type = false;         ///< a type of kervan_msgs, which no ROS 2 reader subscribes with its own QoS
  bool untraced = false;         ///< a port keeps its samples out of the trace
};

/// "1 s, from lab.yaml:5:20 (topic /raw)"
std::string value_and_origin(const QosValue& value);

/// The entry of `topics:` that holds for this topic: the most specific pattern. Two that are equally specific are an
/// error. nullptr if none matches.
const TopicEntry* entry_for(const std::string& topic, const std::vector<TopicEntry>& entries);

/// Profile named by the entry, else declared by the port, with the entry's own values on top. Throws ConfigError if
/// they exclude each other.
EffectiveQos effective_qos(const TopicFacts& topic, const TopicEntry* entry, const Profiles& profiles);

/// Refuses unknown keys and wrong values of one entry of `topics:`.
void check_topic_settings(const config::Node& settings);

}  // namespace kervan::composition
