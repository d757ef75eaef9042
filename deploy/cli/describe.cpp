// kervan describe: what the component types say of themselves.
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "deploy/cli/catalogue.hpp"
#include "deploy/cli/table.hpp"
#include "deploy/cli/verbs.hpp"
#include "deploy/composition/qos_rules.hpp"

namespace kervan::cli {
namespace {

using nlohmann::ordered_json;

std::string unit_of(const ParameterInfo& info) {
  if (info.kind == ParameterKind::duration) return "s";
  if (info.kind == ParameterKind::pose) return "m, m, rad";
  if (info.kind == ParameterKind::points) return "m";
  return info.unit;
}

std::string allowed(const ParameterInfo& info) {
  if (!info.choices.empty()) return config::joined(info.choices);
  const bool low = std::isfinite(info.min), high = std::isfinite(info.max);
  if (!low && !high) return "";
  if (!high) return "at least " + to_text(Value(info.min));
  if (!low) return "at most " + to_text(Value(info.max));
  return to_text(Value(info.min)) + " .. " + to_text(Value(info.max));
}

std::string default_of(const ParameterInfo& info) {
  if (info.required) return "required";
  return info.default_value.empty() ? "" : to_text(info.default_value);
}

void add_parameters(const std::vector<ParameterInfo>& parameters, const std::string& prefix,
                    std::vector<std::vector<std::string>>& rows) {
  for (const ParameterInfo& info : parameters) {
    rows.push_back({prefix + info.name, to_text(info.kind), unit_of(info), default_of(info), allowed(info),
                    info.help + (info.live ? " (may change while running)" : "")});
    add_parameters(info.members, prefix + info.name + ".*.", rows);
  }
}

/// A row for each request, and below it one for each of its arguments.
std::vector<std::vector<std::string>> request_rows(const std::vector<RequestInfo>& requests) {
  std::vector<std::vector<std::string>> rows;
  for (const RequestInfo& request : requests) {
    rows.push_back({request.name, "", "", "", "", request.help});
    add_parameters(request.arguments, request.name + " ", rows);
  }
  return rows;
}

std::string requirements(const PortInfo& port) {
  std::string text = port.qos.profile();
  if (port.qos.max_age() != forever) text += ", at most " + duration_text(port.qos.max_age()) + " old";
  if (port.qos.deadline() != forever) text += ", deadline " + duration_text(port.qos.deadline());
  if (port.qos.lease() != forever) text += ", lease " + duration_text(port.qos.lease());
  if (port.qos.is_lossless()) text += ", lossless";
  if (port.qos.is_from_before()) text += ", also from before";
  if (port.qos.is_optional()) text += ", optional";
  return text;
}

const char* to_text(PortDirection direction) { return direction == PortDirection::input ? "input" : "output"; }

/// What kervan describe says of one type.
struct Description {
  Manifest manifest;
  std::vector<std::string> per_name;  ///< parameters that name things which have ports of their own
  std::string why_no_ports;           ///< the ports are unknown without some parameters; else empty
};

/// The made-up name for which such ports are shown.
constexpr const char* example_name = "r1";

/// A value that a component can be described with; a list has one item. Nobody opens the file.
Value example_of(const ParameterInfo& info) {
  switch (info.kind) {
    case ParameterKind::path:
    case ParameterKind::text: return std::string(example_name);
    case ParameterKind::texts: return ValueList{std::string(example_name)};
    case ParameterKind::numbers: return ValueList{0.0};
    case ParameterKind::points: return ValueList{Value(ValueList{0.0, 0.0})};
    case ParameterKind::pairs: return ValueList{Value(ValueList{std::int64_t{0}, std::int64_t{1}})};
    case ParameterKind::records: {
      ValueMap record;
      for (const ParameterInfo& member : info.members)
        if (member.required) record[member.name] = example_of(member);
      return ValueMap{{example_name, record}};
    }
    default: return info.default_value;
  }
}

/// Some components have a set of ports for each name in a parameter: described without one, the ports would be missing.
void add_example_ports(InstalledComponents& components, Description& description) {
  ValueMap values;
  const std::vector<ParameterInfo> parameters = description.manifest.parameters;
  for (const ParameterInfo& info : parameters) {
    if (info.kind != ParameterKind::records && info.kind != ParameterKind::texts) continue;
    ValueMap with_example = values;
    with_example[info.name] = example_of(info);
    try {
      Manifest manifest = components.manifest(description.manifest.type, with_example);
      if (manifest.ports.size() == description.manifest.ports.size()) continue;
      description.manifest = std::move(manifest);
      description.per_name.push_back(info.name);
      values = std::move(with_example);
    } catch (const std::exception&) {  // the example does not suit it: its ports stay as they are without
    }
  }
}

Description description_of(const std::string& type, ComponentRegistry& registry) {
  InstalledComponents components(registry);
  Description description;
  try {
    description.manifest = components.manifest(type, {});
    add_example_ports(components, description);
  } catch (const std::exception& error) {
    // Some components cannot exist without certain parameters, and their ports depend on them.
    description.manifest.type = type;
    description.manifest.help = registry.find(type)->help;
    description.manifest.parameters = components.parameters(type);
    description.why_no_ports = error.what();
  }
  return description;
}

void print(const Description& description) {
  const Manifest& manifest = description.manifest;
  std::cout << manifest.type << "  " << manifest.help << '\n';
  std::vector<std::vector<std::string>> rows = {{"parameter", "kind", "unit", "default", "allowed", ""}};
  add_parameters(manifest.parameters, "", rows);
  if (rows.size() > 1) {
    std::cout << '\n';
    print_table(std::cout, rows, "  ");
  }
  rows = {{"port", "", "type", "quality of service", ""}};
  for (const PortInfo& port : manifest.ports)
    rows.push_back({port.name, to_text(port.direction), port.type, requirements(port), port.help});
  if (rows.size() > 1) {
    std::cout << '\n';
    print_table(std::cout, rows, "  ");
  }
  rows = {{"request", "kind", "unit", "default", "allowed", ""}};
  for (auto& row : request_rows(manifest.requests)) rows.push_back(std::move(row));
  if (rows.size() > 1) {
    std::cout << '\n';
    print_table(std::cout, rows, "  ");
  }
  for (const std::string& parameter : description.per_name)
    std::cout << "\n  The ports " << example_name << "/… are there once for each name in " << parameter << ".\n";
}

/// Text in a cell of a Markdown table.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '<')
      escaped += "&lt;";
    else
      escaped += c == '|' || c == '*' ? std::string{'\\', c} : std::string{c};
  }
  return escaped;
}

std::string code(const std::string& text) { return text.empty() ? "" : "`" + text + "`"; }

void print_rows(const std::vector<std::vector<std::string>>& rows) {
  for (const auto& row : rows) {
    std::cout << '|';
    for (const std::string& text : row) std::cout << (text.empty() ? " |" : " " + text + " |");
    std::cout << '\n';
  }
}

/// The section of a component's page that stands between its two markers.
void print_markdown(const Description& description) {
  for (const std::string& parameter : description.per_name)
    std::cout << "The ports `" << example_name << "/…` are there once for each name in `" << parameter << "`.\n\n";
  std::vector<std::vector<std::string>> rows = {{"port", "direction", "type", "quality of service", "help"},
                                                {"---", "---", "---", "---", "---"}};
  for (const PortInfo& port : description.manifest.ports)
    rows.push_back({code(port.name), to_text(port.direction), code(port.type), requirements(port), cell(port.help)});
  if (rows.size() > 2) print_rows(rows);

  bool first = rows.size() <= 2;
  const auto print_values = [&](const char* what, const std::vector<std::vector<std::string>>& values) {
    if (values.empty()) return;
    if (!std::exchange(first, false)) std::cout << '\n';
    rows = {{what, "kind", "unit", "default", "allowed", "help"}, {"---", "---", "---", "---", "---", "---"}};
    for (const auto& row : values)
      rows.push_back({code(row[0]), cell(row[1]), row[2], row[3] == "required" ? row[3] : code(row[3]), cell(row[4]),
                      cell(row[5])});
    print_rows(rows);
  };
  std::vector<std::vector<std::string>> parameters;
  add_parameters(description.manifest.parameters, "", parameters);
  print_values("parameter", parameters);
  print_values("request", request_rows(description.manifest.requests));
}

ordered_json json_of(const Value& value) {
  struct Convert {
    ordered_json operator()(std::monostate) const { return nullptr; }
    ordered_json operator()(bool v) const { return v; }
    ordered_json operator()(std::int64_t v) const { return v; }
    ordered_json operator()(double v) const { return v; }
    ordered_json operator()(const std::string& v) const { return v; }
    ordered_json operator()(const ValueList& list) const {
      ordered_json array = ordered_json::array();
      for (const Value& item : list) array.push_back(json_of(item));
      return array;
    }
    ordered_json operator()(const ValueMap& map) const {
      ordered_json object = ordered_json::object();
      for (const auto& [key, item] : map) object[key] = json_of(item);
      return object;
    }
  };
  return std::visit(Convert{}, static_cast<const Value::variant&>(value));
}

ordered_json json_of(const std::vector<ParameterInfo>& parameters) {
  ordered_json list = ordered_json::array();
  for (const ParameterInfo& info : parameters) {
    ordered_json object = {{"name", info.name},
                           {"kind", to_text(info.kind)},
                           {"unit", unit_of(info)},
                           {"help", info.help},
                           {"required", info.required},
                           {"live", info.live},
                           {"default", json_of(info.default_value)}};
    if (std::isfinite(info.min)) object["min"] = info.min;
    if (std::isfinite(info.max)) object["max"] = info.max;
    if (!info.choices.empty()) object["choices"] = info.choices;
    if (!info.members.empty()) object["members"] = json_of(info.members);
    list.push_back(std::move(object));
  }
  return list;
}

ordered_json json_of(const Manifest& manifest) {
  ordered_json object = {
      {"type", manifest.type}, {"help", manifest.help}, {"parameters", json_of(manifest.parameters)}};
  object["ports"] = ordered_json::array();
  for (const PortInfo& port : manifest.ports) {
    ordered_json info = {
        {"name", port.name},   {"direction", to_text(port.direction)}, {"type", port.type},
        {"keyed", port.keyed}, {"profile", port.qos.profile()},        {"optional", port.qos.is_optional()},
        {"help", port.help}};
    if (port.qos.max_age() != forever) info["max_age_s"] = seconds(port.qos.max_age());
    if (port.qos.deadline() != forever) info["deadline_s"] = seconds(port.qos.deadline());
    object["ports"].push_back(std::move(info));
  }
  object["requests"] = ordered_json::array();
  for (const RequestInfo& request : manifest.requests)
    object["requests"].push_back(
        {{"name", request.name}, {"help", request.help}, {"arguments", json_of(request.arguments)}});
  object["timers"] = ordered_json::array();
  for (const TimerInfo& timer : manifest.timers) object["timers"].push_back({{"period_s", seconds(timer.period)}});
  object["own_thread"] = manifest.own_thread;
  return object;
}

/// One module that cannot be loaded must not hide the others: it is listed with the reason.
int list_all(ComponentRegistry& registry, bool json) {
  int code = exit_good;
  std::vector<std::vector<std::string>> rows;
  ordered_json components = ordered_json::array();
  for (const std::string& name : registry.names()) {
    try {
      const std::string help = registry.find(name)->help;
      rows.push_back({name, help});
      components.push_back({{"type", name}, {"help", help}});
    } catch (const std::exception& error) {
      code = exit_found;
      rows.push_back({name, std::string("cannot be loaded: ") + error.what()});
      components.push_back({{"type", name}, {"error", error.what()}});
    }
  }
  if (json)
    std::cout << ordered_json{{"components", components}}.dump() << std::endl;
  else
    print_table(std::cout, rows);
  if (rows.empty()) std::cerr << "no components found; KERVAN_COMPONENT_PATH names the folders to look in\n";
  return code;
}

}  // namespace

int describe(const DescribeRequest& request) {
  ComponentRegistry registry(component_folders());
  if (request.component.empty()) return list_all(registry, request.json);
  const auto names = registry.names();
  if (std::find(names.begin(), names.end(), request.component) == names.end())
    throw ConfigError({}, "there is no component type '" + request.component + "'" +
                              config::hint(request.component, names, "there are"));
  const Description description = description_of(request.component, registry);
  if (request.json) {
    ordered_json object = json_of(description.manifest);
    if (!description.per_name.empty()) object["ports_for_each_name_in"] = description.per_name;
    std::cout << object.dump() << std::endl;
  } else if (request.markdown) {
    print_markdown(description);
  } else {
    print(description);
  }
  if (!description.why_no_ports.empty())
    std::cerr << "the ports depend on the parameters, see kervan check; without any: " << description.why_no_ports
              << '\n';
  return exit_good;
}

}  // namespace kervan::cli
