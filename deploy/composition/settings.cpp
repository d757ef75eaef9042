#include "deploy/composition/settings.hpp"

#include <algorithm>
#include <set>

namespace kervan::composition {
namespace {

using config::Node;

Node& child_of(Node& map, const std::string& name, const Node& setting) {
  if (!map.is_map()) setting.fail_at_key("'" + map.name + "' is " + map.shown() + ", so nothing below it can be set");
  for (Node& child : map.children)
    if (child.name == name) return child;
  Node made;
  made.kind = config::Kind::map;
  made.name = name;
  made.location = made.key_location = setting.key_location;
  map.children.push_back(std::move(made));
  return map.children.back();
}

void apply(Composition& composition, const Node& setting) {
  const std::vector<std::string> path = split_path(setting.name);
  std::vector<std::string> names;
  for (const ComponentEntry& entry : composition.components) names.push_back(entry.name);
  const auto entry = std::ranges::find(composition.components, path[0], &ComponentEntry::name);
  if (entry == composition.components.end())
    setting.fail_at_key("there is no component '" + path[0] + "'" + config::hint(path[0], names, "there are"));
  if (path.size() < 3 || path[1] != "params" || std::ranges::find(path, "") != path.end())
    setting.fail_at_key("'" + setting.name + "' names no parameter; write " + path[0] + ".params.NAME");
  put(entry->params, std::span(path).subspan(2), setting);
}

}  // namespace

std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

void put(Node& map, std::span<const std::string> path, const Node& setting) {
  Node* node = &map;
  for (const std::string& part : path) node = &child_of(*node, part, setting);
  const std::string name = node->name;
  *node = setting;
  node->name = name;
}

std::vector<Node> settings_from_command_line(const std::vector<std::string>& given) {
  std::vector<Node> settings;
  for (const std::string& text : given) {
    const Location origin{"--set " + text, 0, 0};
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) throw ConfigError(origin, "write --set COMPONENT.params.NAME=VALUE");
    const std::string value = text.substr(equals + 1);
    const bool nested = value.starts_with('[') || value.starts_with('{');
    Node node;
    try {
      node = nested ? config::parse(value, origin.file) : config::scalar(value, "", origin.file);
    } catch (const ConfigError&) {
      throw ConfigError(origin, "'" + value + "' is no list and no map");
    }
    node.name = text.substr(0, equals);
    node.location = node.key_location = origin;
    settings.push_back(std::move(node));
  }
  return settings;
}

void apply_settings(Composition& composition, const std::vector<Node>& settings) {
  std::set<std::string> seen;
  for (const Node& setting : settings) {
    if (!seen.insert(setting.name).second)
      setting.fail_at_key("'" + setting.name + "' is set twice; keep one of the two");
    apply(composition, setting);
  }
}

}  // namespace kervan::composition
