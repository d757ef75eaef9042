#include "framework/config/node.hpp"

#include <algorithm>
#include <charconv>

#include "framework/component/parameters.hpp"
#include "framework/config/quantity.hpp"

namespace kervan::config {
namespace {

const char* to_text(Kind kind) {
  switch (kind) {
    case Kind::null:
      return "nothing";
    case Kind::scalar:
      return "a single value";
    case Kind::list:
      return "a list";
    case Kind::map:
      return "a map";
  }
  return "";
}

/// What people write for booleans elsewhere in YAML, and what they mean by it.
std::optional<bool> meant_as_bool(std::string word) {
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  if (word == "yes" || word == "on" || word == "y" || word == "true" || word == "1") return true;
  if (word == "no" || word == "off" || word == "n" || word == "false" || word == "0") return false;
  return std::nullopt;
}

void require_unquoted(const Node& node, const char* what) {
  if (node.quoted) node.fail(node.shown() + " is a text because of its quotes; write " + what + " without quotes");
}

}  // namespace

const std::vector<Node>& Node::map() const {
  if (is_map()) return children;
  if (kind == Kind::null) fail("a map is missing here; write {} for an empty one");
  fail("expected a map (key: value), found " + shown());
}

const std::vector<Node>& Node::list() const {
  if (is_list()) return children;
  if (kind == Kind::null) fail("a list is missing here; write [] for an empty one");
  fail("expected a list, found " + shown());
}

const std::vector<Node>& Node::list_of(std::size_t count, std::string_view what) const {
  if (!is_list()) fail("expected " + std::string(what) + ", found " + shown());
  if (children.size() != count)
    fail("expected " + std::string(what) + ", found a list of " + std::to_string(children.size()));
  return children;
}

const Node* Node::optional(std::string_view key) const {
  for (const Node& child : map())
    if (child.name == key) return &child;
  return nullptr;
}

const Node& Node::required(std::string_view key) const {
  if (const Node* found = optional(key)) return *found;
  fail("the key '" + std::string(key) + "' is missing");
}

void Node::only_keys(const std::vector<std::string>& allowed) const {
  for (const Node& child : map()) {
    if (std::find(allowed.begin(), allowed.end(), child.name) != allowed.end()) continue;
    throw ConfigError(child.key_location, "unknown key '" + child.name + "'" + hint(child.name, allowed, "allowed"));
  }
}

bool Node::as_bool() const {
  if (!is_scalar()) fail("expected true or false, found " + shown());
  require_unquoted(*this, "true or false");
  if (text == "true") return true;
  if (text == "false") return false;
  if (const auto meant = meant_as_bool(text))
    fail("'" + text + "' is not a boolean; write " + (*meant ? "true" : "false") +
         " (only true and false are booleans)");
  fail("expected true or false, found " + shown());
}

std::int64_t Node::as_integer() const {
  if (!is_scalar()) fail("expected an integer, found " + shown());
  require_unquoted(*this, "the number");
  const std::size_t sign = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
  const bool digits = text.size() > sign && text.find_first_not_of("0123456789", sign) == std::string::npos;
  if (!digits) {
    const auto number = parse_number(text);
    if (std::holds_alternative<std::string>(number)) fail("expected an integer: " + std::get<std::string>(number));
    fail(shown() + " is not an integer; write a whole number without point or exponent");
  }
  if (text.size() > sign + 1 && text[sign] == '0')
    fail("'" + text + "' begins with a zero, which some read as octal; write it without");
  const char* begin = text.data() + (text[0] == '+' ? 1 : 0);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc()) fail(shown() + " does not fit into 64 bits");
  return value;
}

double Node::as_number() const { return as_quantity(""); }

double Node::as_quantity(std::string_view unit) const {
  const std::string what = unit.empty() ? "a number" : "a number with a unit (" + joined(units_of(unit)) + ")";
  if (!is_scalar()) fail("expected " + what + ", found " + shown());
  require_unquoted(*this, unit.empty() ? "the number" : "number and unit");
  const auto value = parse_quantity(text, unit);
  if (const auto* trouble = std::get_if<std::string>(&value))
    fail(*trouble + (written.empty() ? "" : " (from " + written + ")"));
  return std::get<double>(value);
}

Duration Node::as_duration() const {
  const double s = as_quantity("s");
  if (std::abs(s) > 9.0e9) fail(shown() + " is too long; the longest time is 9000000000 s");
  return from_seconds(s);
}

std::string Node::as_text() const {
  if (!is_scalar()) fail("expected a text, found " + shown());
  return text;
}

std::string Node::as_choice(const std::vector<std::string>& choices) const {
  if (!is_scalar()) fail("expected one of " + joined(choices) + ", found " + shown());
  if (std::find(choices.begin(), choices.end(), text) == choices.end())
    fail(shown() + " is not one of " + joined(choices) + did_you_mean(text, choices));
  return text;
}

std::vector<double> Node::as_quantities(std::string_view unit) const {
  std::vector<double> values;
  for (const Node& item : list()) values.push_back(item.as_quantity(unit));
  return values;
}

geometry::Vector2 Node::as_point() const {
  const auto& items = list_of(2, "a point [x m, y m]");
  return {items[0].as_quantity("m"), items[1].as_quantity("m")};
}

geometry::Pose2 Node::as_pose() const {
  const auto& items = list_of(3, "a pose [x m, y m, yaw deg]");
  return {items[0].as_quantity("m"), items[1].as_quantity("m"), items[2].as_quantity("rad")};
}

const Node& Node::nearest_to(std::string_view path) const {
  const Node* node = this;
  while (!path.empty()) {
    const Node* next = nullptr;
    if (path.front() == '[') {
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(path.data() + 1, path.data() + path.size(), index);
      if (error != std::errc() || !node->is_list() || index >= node->children.size()) return *node;
      next = &node->children[index];
      path.remove_prefix(static_cast<std::size_t>(end - path.data()));
      if (path.starts_with(']')) path.remove_prefix(1);
    } else {
      if (path.front() == '.') path.remove_prefix(1);
      const std::string_view key = path.substr(0, path.find_first_of(".["));
      if (node->is_map())
        for (const Node& child : node->children)
          if (child.name == key) next = &child;
      path.remove_prefix(key.size());
    }
    if (next == nullptr) return *node;
    node = next;
  }
  return *node;
}

void Node::fail(const std::string& message) const {
  throw ConfigError(location, name.empty() ? message : name + ": " + message);
}

void Node::fail_at_key(const std::string& message) const { throw ConfigError(key_location, message); }

std::string Node::shown() const {
  if (!is_scalar()) return to_text(kind);
  constexpr std::size_t longest = 60;
  const std::string seen = text.size() > longest ? text.substr(0, longest) + "..." : text;
  const std::string value = quoted ? '"' + seen + '"' : text.empty() ? "an empty text" : seen;
  return written.empty() ? value : value + " (from " + written + ")";
}

Node scalar(std::string text, std::string name, std::string origin) {
  Node node;
  node.kind = Kind::scalar;
  node.name = std::move(name);
  node.text = std::move(text);
  node.location.file = std::move(origin);
  node.key_location = node.location;
  return node;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const auto near = nearest(word, known);
  return near ? "; did you mean '" + *near + "'?" : "";
}

std::string hint(const std::string& word, const std::vector<std::string>& known, const std::string& label) {
  const std::string meant = did_you_mean(word, known);
  return (meant.empty() ? ";" : meant) + " " + label + ": " + joined(known);
}

std::string joined(const std::vector<std::string>& words) {
  if (words.empty()) return "none";
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

}  // namespace kervan::config
