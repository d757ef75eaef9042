/// A composition compared with what its components say of themselves: typed parameters, ports on topics, one effective
/// quality of service for each topic, and everything that does not fit together.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "deploy/composition/composition.hpp"
#include "deploy/composition/qos_rules.hpp"
#include "framework/component/manifest.hpp"

namespace kervan::composition {

/// Where component types come from; tests bring their own.
class ComponentCatalogue {
 public:
  virtual ~ComponentCatalogue() = default;

  /// All types there are, for suggestions.
  virtual std::vector<std::string> types() const = 0;

  /// The parameters of a type, needed to read the values that a composition gives them.
  virtual std::vector<ParameterInfo> parameters(const std::string& type) = 0;

  /// The manifest with these values; ports may depend on them. May throw ParameterError or ConfigError.
  virtual Manifest manifest(const std::string& type, const ValueMap& values) = 0;
};

struct ResolveOptions {
  std::vector<std::filesystem::path>
      resource_folders;                      ///< where path parameters are looked up after the file's own folder
  std::vector<std::string> external_topics;  ///< written by the framework itself: no writer is missed there
};

struct ResolvedPort {
  PortInfo info;
  std::string topic;  ///< absolute: "/r1/sonar"
  Location location;  ///< of the remap, else of the name in a parameter that it belongs to, else of the component
  std::optional<int> strength = {};  ///< of an output, if the composition gives it one
  Location strength_location = {};
};

struct ResolvedComponent {
  std::string name;  ///< "r1/control"
  std::string container;
  std::string log_level;
  ValueMap parameters;  ///< those the composition gives, in SI units
  Manifest manifest;
  std::vector<ResolvedPort> ports;  ///< in the manifest's order
  Location location;
};

struct PortReference {
  std::size_t component = 0;  ///< index into ResolvedComposition::components
  std::size_t port = 0;       ///< index into its ports

  bool operator==(const PortReference&) const = default;
};

struct ResolvedTopic {
  std::string name;
  std::string type;
  std::uint64_t layout_hash = 0;
  EffectiveQos qos;
  std::vector<PortReference> writers, readers;  ///< in the order of components and ports
};

enum class Severity { warning, error };

/// Something about how components fit together; what is wrong in the file alone is a ConfigError instead.
struct Finding {
  Severity severity = Severity::error;
  Location location;
  std::string message;
};

/// One writer and one reader of a topic; empty if it has none. The verdict is "ok" or what is wrong.
struct Pair {
  std::string topic, type, writer, reader, profile, verdict;
};

struct ResolvedComposition {
  Composition source;
  std::vector<ResolvedComponent> components;  ///< in the composition's order, which is the order of lockstep
  std::map<std::string, ResolvedTopic> topics;
  std::vector<Pair> pairs;
  std::vector<Finding> findings;

  const ResolvedPort& port(PortReference reference) const {
    return components[reference.component].ports[reference.port];
  }
  /// "r1/control.goal"
  std::string port_name(PortReference reference) const;
  bool usable() const;  ///< no finding is an error
};

/// Throws ConfigError for the first thing in the file that cannot be used; how the ports fit together is in `findings`.
ResolvedComposition resolve(Composition composition, ComponentCatalogue& catalogue, const ResolveOptions& options = {});

}  // namespace kervan::composition
