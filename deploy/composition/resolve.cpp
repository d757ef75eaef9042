#include "deploy/composition/resolve.hpp"

#include <algorithm>

#include "deploy/composition/clock_rules.hpp"
#include "deploy/composition/load.hpp"
#include "deploy/composition/topics.hpp"
#include "framework/config/values.hpp"

namespace kervan::composition {
namespace {

using config::Node;
namespace fs = std::filesystem;

/// Looks up path parameters: as they are if absolute, else beside the composition, else in the resource folders.
std::string find_file(const Node& node, const fs::path& folder, const std::vector<fs::path>& resource_folders) {
  const fs::path path = node.as_text();
  std::vector<fs::path> tried;
  if (path.is_absolute()) {
    tried.push_back(path);
  } else {
    tried.push_back(folder / path);
    for (const fs::path& resources : resource_folders) tried.push_back(resources / path);
  }
  std::string list;
  for (const fs::path& candidate : tried) {
    if (fs::is_regular_file(candidate)) return fs::canonical(candidate).string();
    list += (list.empty() ? "" : ", ") + shown_path(candidate);
  }
  node.fail("there is no file " + node.shown() + "; looked for " + list);
}

/// Where a port comes from. One whose name begins with a name in a parameter (`goals: {r1: …}` has the port r1/goal) is
/// there because of that line; any other because of the component.
Location location_of(const PortInfo& port, const ComponentEntry& entry, const std::vector<ParameterInfo>& parameters) {
  const std::size_t slash = port.name.find('/');
  if (slash == std::string::npos) return entry.location;
  const std::string name = port.name.substr(0, slash);
  for (const ParameterInfo& info : parameters) {
    const Node* given = entry.params.optional(info.name);
    if (given == nullptr) continue;
    for (const Node& item : given->children) {
      if (info.kind == ParameterKind::records && item.name == name) return item.key_location;
      if (info.kind == ParameterKind::texts && item.text == name) return item.location;
    }
  }
  return entry.location;
}

void give_strengths(ResolvedComponent& component, const ComponentEntry& entry) {
  std::vector<std::string> outputs;
  for (const ResolvedPort& port : component.ports)
    if (port.info.direction == PortDirection::output) outputs.push_back(port.info.name);
  for (const Node& given : entry.strength.map()) {
    const auto port = std::find_if(component.ports.begin(), component.ports.end(), [&](const ResolvedPort& p) {
      return p.info.direction == PortDirection::output && p.info.name == given.name;
    });
    if (port == component.ports.end())
      given.fail_at_key(component.manifest.type + " has no output '" + given.name + "'" +
                        config::hint(given.name, outputs, "it has"));
    const std::int64_t strength = given.as_integer();
    if (strength < 0 || strength > 1'000'000) given.fail(given.shown() + " is out of range; allowed: 0 .. 1000000");
    port->strength = static_cast<int>(strength);
    port->strength_location = given.location;
  }
}

ResolvedComponent resolve_component(const ComponentEntry& entry, ComponentCatalogue& catalogue,
                                    const config::FindFile& find) {
  const std::string type = entry.type.as_text();
  const std::vector<std::string> types = catalogue.types();
  if (std::find(types.begin(), types.end(), type) == types.end())
    entry.type.fail("there is no component type '" + type + "'" + config::hint(type, types, "there are"));
  ResolvedComponent component;
  component.name = entry.name;
  component.log_level = entry.log_level;
  component.location = entry.location;
  try {
    component.parameters = config::to_values(entry.params, catalogue.parameters(type), type, find);
    component.manifest = catalogue.manifest(type, component.parameters);
  } catch (const ParameterError& error) {
    const Node& at = entry.params.nearest_to(error.parameter());
    throw ConfigError(at.location, error.parameter() + ": " + error.message());
  } catch (const ConfigError&) {
    throw;
  } catch (const std::exception& error) {
    entry.type.fail("'" + type + "' cannot be used: " + error.what());
  }
  for (const PortInfo& port : component.manifest.ports)
    component.ports.push_back({port, "", location_of(port, entry, component.manifest.parameters)});
  give_strengths(component, entry);
  return component;
}

}  // namespace

std::string ResolvedComposition::port_name(PortReference reference) const {
  return components[reference.component].name + "." + port(reference).info.name;
}

bool ResolvedComposition::usable() const {
  return std::none_of(findings.begin(), findings.end(), [](const Finding& f) { return f.severity == Severity::error; });
}

ResolvedComposition resolve(Composition composition, ComponentCatalogue& catalogue, const ResolveOptions& options) {
  ResolvedComposition resolved;
  const config::FindFile find = [&](const Node& node) {
    return find_file(node, composition.folder, options.resource_folders);
  };
  for (const ComponentEntry& entry : composition.components)
    resolved.components.push_back(resolve_component(entry, catalogue, find));
  for (const Container& container : composition.containers)
    for (ResolvedComponent& component : resolved.components)
      if (std::find(container.components.begin(), container.components.end(), component.name) !=
          container.components.end())
        component.container = container.name;
  resolved.source = std::move(composition);
  name_topics(resolved);
  judge_clock(resolved);
  connect(resolved, options);
  return resolved;
}

}  // namespace kervan::composition
