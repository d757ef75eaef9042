#include "deploy/composition/arguments.hpp"

#include <algorithm>
#include <set>

#include "framework/config/values.hpp"

namespace kervan::composition {
namespace {

using config::Node;

struct TypeWord {
  const char* word;
  ParameterKind kind;
};

constexpr TypeWord type_words[] = {
    {"bool", ParameterKind::boolean},      {"int", ParameterKind::integer}, {"number", ParameterKind::number},
    {"duration", ParameterKind::duration}, {"text", ParameterKind::text},   {"enum", ParameterKind::choice},
    {"path", ParameterKind::path},         {"pose", ParameterKind::pose},   {"points", ParameterKind::points},
};

ParameterKind kind_of(const Node& type) {
  std::vector<std::string> words;
  for (const TypeWord& known : type_words) words.emplace_back(known.word);
  const std::string word = type.as_choice(words);
  return std::find_if(std::begin(type_words), std::end(type_words), [&](const TypeWord& t) { return word == t.word; })
      ->kind;
}

double limit(const Node& node, const ParameterInfo& info) {
  if (info.kind == ParameterKind::integer) return static_cast<double>(node.as_integer());
  if (info.kind == ParameterKind::duration) return node.as_quantity("s");
  return node.as_quantity(info.unit);
}

void read_range(const Node& range, ParameterInfo& info) {
  if (info.kind != ParameterKind::integer && info.kind != ParameterKind::number && info.kind != ParameterKind::duration)
    range.fail_at_key("'range' is for int, number and duration only");
  const auto& limits = range.list_of(2, "a range [least, most]");
  info.min = limit(limits[0], info);
  info.max = limit(limits[1], info);
  if (info.min > info.max) range.fail("the least value is above the most");
}

Argument declare(const Node& declaration) {
  declaration.only_keys({"type", "values", "default", "range", "unit", "help"});
  Argument argument;
  argument.location = declaration.key_location;
  ParameterInfo& info = argument.info;
  info.name = declaration.name;
  info.kind = kind_of(declaration.required("type"));
  if (const Node* unit = declaration.optional("unit")) {
    if (info.kind != ParameterKind::number) unit->fail_at_key("'unit' is for number only");
    info.unit = unit->as_text();
  }
  if (info.kind == ParameterKind::choice) {
    for (const Node& value : declaration.required("values").list()) info.choices.push_back(value.as_text());
    if (info.choices.empty()) declaration.required("values").fail("an enum needs at least one value");
  } else if (const Node* values = declaration.optional("values")) {
    values->fail_at_key("'values' is for enum only");
  }
  if (const Node* range = declaration.optional("range")) read_range(*range, info);
  if (const Node* help = declaration.optional("help")) info.help = help->as_text();
  if (const Node* value = declaration.optional("default")) give(argument, *value);
  return argument;
}

std::vector<std::string> names_of(const std::vector<Argument>& arguments) {
  std::vector<std::string> names;
  for (const Argument& argument : arguments) names.push_back(argument.info.name);
  return names;
}

template <class Arguments>
auto* find(Arguments& arguments, const std::string& name) {
  const auto found = std::find_if(arguments.begin(), arguments.end(),
                                  [&](const Argument& argument) { return argument.info.name == name; });
  return found == arguments.end() ? nullptr : &*found;
}

/// A list from the command line. What the parser says of an unclosed bracket is meant for files, not for one line.
Node parse_list(const std::string& text, ParameterKind kind, const Location& origin) {
  try {
    return config::parse(text, origin.file);
  } catch (const ConfigError&) {
    throw ConfigError(origin, kind == ParameterKind::pose
                                  ? "'" + text + "' is not a pose; write e.g. [1 m, 2 m, 90 deg]"
                                  : "'" + text + "' is not a list of points; write e.g. [[0 m, 0 m], [1 m, 50 cm]]");
  }
}

/// Replaces `${name}`s in a scalar.
class Substitution {
 public:
  Substitution(const Node& place, const std::vector<Argument>& arguments) : place_(place), arguments_(arguments) {}

  Node result() const {
    const std::string& text = place_.text;
    if (text.starts_with("${") && text.find('}') == text.size() - 1) return whole();
    Node node = place_;
    node.text.clear();
    node.written = text;
    std::size_t at = 0;
    for (std::size_t open = text.find("${"); open != std::string::npos; open = text.find("${", at)) {
      node.text += text.substr(at, open - at);
      const std::size_t close = text.find('}', open);
      if (close == std::string::npos) place_.fail("'${' is not closed by '}'");
      const Node& value = value_of(text.substr(open + 2, close - open - 2));
      if (!value.is_scalar())
        place_.fail("${" + value.name + "} is " + value.shown() + " and cannot be part of a text");
      node.text += value.text;
      at = close + 1;
    }
    node.text += text.substr(at);
    return node;
  }

 private:
  Node whole() const {
    Node node = value_of(place_.text.substr(2, place_.text.size() - 3));
    node.name = place_.name;
    node.location = place_.location;
    node.key_location = place_.key_location;
    node.written = place_.text;
    return node;
  }

  const Node& value_of(const std::string& name) const {
    const Argument* argument = find(arguments_, name);
    if (argument == nullptr || !argument->value)
      place_.fail("there is no argument '" + name + "'" + config::hint(name, names_of(arguments_), "declared"));
    return *argument->value;
  }

  const Node& place_;
  const std::vector<Argument>& arguments_;
};

}  // namespace

std::vector<Argument> declare_arguments(const Node& declarations) {
  std::vector<Argument> arguments;
  for (const Node& declaration : declarations.map()) arguments.push_back(declare(declaration));
  return arguments;
}

void give(Argument& argument, const Node& value) {
  config::to_value(value, argument.info);
  argument.value = value;
}

void give_values(std::vector<Argument>& arguments, const std::vector<Node>& values, const std::string& of) {
  for (const Node& value : values) {
    Argument* argument = find(arguments, value.name);
    if (argument == nullptr)
      value.fail_at_key(of + " has no argument '" + value.name + "'" +
                        config::hint(value.name, names_of(arguments), "it has"));
    give(*argument, value);
  }
}

void give_from_command_line(std::vector<Argument>& arguments, const std::vector<std::string>& given) {
  std::set<std::string> seen;
  for (const std::string& text : given) {
    const Location origin{"--arg " + text, 0, 0};
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) throw ConfigError(origin, "write --arg name=value");
    const std::string name = text.substr(0, equals), value = text.substr(equals + 1);
    Argument* argument = find(arguments, name);
    if (argument == nullptr) {
      const auto names = names_of(arguments);
      throw ConfigError(origin, "the composition has no argument '" + name + "'" + config::hint(name, names, "it has"));
    }
    if (!seen.insert(name).second) throw ConfigError(origin, "'" + name + "' is given twice; keep one of the two");
    const ParameterKind kind = argument->info.kind;
    const bool is_list = kind == ParameterKind::pose || kind == ParameterKind::points;
    give(*argument, is_list ? parse_list(value, kind, origin) : config::scalar(value, "", origin.file));
  }
  for (const Argument& argument : arguments)
    if (!argument.value)
      throw ConfigError(argument.location, "the argument '" + argument.info.name + "' has no default; give --arg " +
                                               argument.info.name + "=VALUE" +
                                               (argument.info.help.empty() ? "" : " (" + argument.info.help + ")"));
}

Node substitute(const Node& node, const std::vector<Argument>& arguments) {
  if (node.is_scalar() && node.text.find("${") != std::string::npos) return Substitution(node, arguments).result();
  Node copy = node;
  for (Node& child : copy.children) {
    if (node.is_map() && child.name.find("${") != std::string::npos)
      child.fail_at_key("'" + child.name + "': ${} works in values only, not in keys");
    child = substitute(child, arguments);
  }
  return copy;
}

}  // namespace kervan::composition
