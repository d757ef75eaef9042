#include "deploy/composition/expand.hpp"

#include <algorithm>
#include <cctype>

#include "deploy/composition/arguments.hpp"
#include "deploy/composition/settings.hpp"

namespace kervan::composition {
namespace {

using config::Node;

Node empty_map_at(const Location& location) {
  Node node;
  node.kind = config::Kind::map;
  node.location = node.key_location = location;
  return node;
}

Node map_or_empty(const Node& parent, const char* key) {
  const Node* found = parent.optional(key);
  if (found == nullptr) return empty_map_at(parent.key_location);
  found->map();
  return *found;
}

std::vector<std::string> keys_of(const Node& map) {
  std::vector<std::string> keys;
  for (const Node& child : map.children) keys.push_back(child.name);
  return keys;
}

Node* child_of(Node& map, const std::string& key) {
  const auto found =
      std::find_if(map.children.begin(), map.children.end(), [&](const Node& c) { return c.name == key; });
  return found == map.children.end() ? nullptr : &*found;
}

ComponentEntry component_of(const Node& node, const std::string& scope, const std::string& log_level) {
  node.only_keys({"type", "params", "remap", "strength", "log"});
  ComponentEntry entry;
  entry.name = scope.empty() ? node.name : scope + "/" + node.name;
  entry.scope = scope;
  entry.type = node.required("type");
  entry.type.as_text();
  entry.params = map_or_empty(node, "params");
  entry.remap = map_or_empty(node, "remap");
  entry.strength = map_or_empty(node, "strength");
  const Node* log = node.optional("log");
  entry.log_level = log ? log_level_of(*log) : log_level;
  entry.location = node.key_location;
  return entry;
}

/// One line of `set:`; its key is a path such as `mapper.params.update` into the template's components.
void set_value(Node& components, const Node& setting, const std::string& template_name) {
  const std::vector<std::string> path = split_path(setting.name);
  Node* node = child_of(components, path[0]);
  if (node == nullptr)
    setting.fail_at_key("the template '" + template_name + "' has no component '" + path[0] + "'" +
                        config::did_you_mean(path[0], keys_of(components)));
  const std::vector<std::string> allowed = {"type", "params", "remap", "strength", "log"};
  if (path.size() < 2 || std::find(allowed.begin(), allowed.end(), path[1]) == allowed.end())
    setting.fail_at_key("'" + setting.name + "' names nothing that can be set; write e.g. " + path[0] +
                        ".params.NAME, " + path[0] + ".remap.PORT or " + path[0] + ".log");
  put(*node, std::span(path).subspan(1), setting);
}

/// The values that an instance gives to its template's parameters, beside the composition's arguments.
std::vector<Argument> scope_of(const Node& definition, const Node& instance, const std::vector<Argument>& arguments) {
  std::vector<Argument> scope;
  if (const Node* params = definition.optional("params")) scope = declare_arguments(*params);
  std::vector<std::string> names;
  for (const Argument& parameter : scope) {
    names.push_back(parameter.info.name);
    for (const Argument& argument : arguments)
      if (argument.info.name == parameter.info.name)
        throw ConfigError(parameter.location, "'" + parameter.info.name +
                                                  "' is already an argument of the composition (" +
                                                  to_text(argument.location) + "); use another name");
  }
  const Node with = map_or_empty(instance, "with");
  for (const Node& given : with.map()) {
    const auto parameter =
        std::find_if(scope.begin(), scope.end(), [&](const Argument& p) { return p.info.name == given.name; });
    if (parameter == scope.end())
      given.fail_at_key("the template '" + definition.name + "' has no parameter '" + given.name + "'" +
                        config::hint(given.name, names, "it has"));
    give(*parameter, substitute(given, arguments));
  }
  for (const Argument& parameter : scope)
    if (!parameter.value)
      with.fail("the parameter '" + parameter.info.name + "' of the template '" + definition.name + "' is missing");
  scope.insert(scope.end(), arguments.begin(), arguments.end());
  return scope;
}

void expand_instance(const Node& instance, const Node* templates, const std::vector<Argument>& arguments,
                     const std::string& log_level, std::vector<ComponentEntry>& entries) {
  instance.only_keys({"template", "with", "set"});
  const Node reference = substitute(instance.required("template"), arguments);
  const std::string name = reference.as_text();
  const std::vector<std::string> known = templates ? keys_of(*templates) : std::vector<std::string>{};
  const Node* definition = templates ? templates->optional(name) : nullptr;
  if (definition == nullptr)
    reference.fail("there is no template '" + name + "'" + config::hint(name, known, "there are"));
  Node components = substitute(definition->required("components"), scope_of(*definition, instance, arguments));
  const Node settings = map_or_empty(instance, "set");
  for (const Node& setting : settings.map()) set_value(components, substitute(setting, arguments), name);
  for (const Node& component : components.map()) entries.push_back(component_of(component, instance.name, log_level));
}

void check_template(const Node& definition) {
  require_name(definition, "template");
  definition.only_keys({"params", "components", "help"});
  for (const Node& component : definition.required("components").map()) {
    require_name(component, "component");
    if (component.optional("template"))
      component.required("template")
          .fail_at_key("a template cannot hold an instance of a template; write its components out");
  }
}

}  // namespace

void require_name(const Node& node, const char* what) {
  const std::string& name = node.name;
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  const auto is_allowed = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  if (!name.empty() && is_letter(name[0]) && std::all_of(name.begin(), name.end(), is_allowed)) return;
  node.fail_at_key("'" + name + "' is not a name for a " + what + "; use a letter, then letters, digits and _");
}

std::string log_level_of(const Node& node) {
  return node.as_choice({"trace", "debug", "info", "warn", "error", "off"});
}

std::vector<ComponentEntry> expand_components(const Node& components, const Node* templates,
                                              const std::vector<Argument>& arguments, const std::string& log_level) {
  if (templates)
    for (const Node& definition : templates->map()) check_template(definition);
  std::vector<ComponentEntry> entries;
  for (const Node& node : components.map()) {
    require_name(node, "component");
    if (node.optional("template"))
      expand_instance(node, templates, arguments, log_level, entries);
    else
      entries.push_back(component_of(substitute(node, arguments), "", log_level));
  }
  return entries;
}

}  // namespace kervan::composition
