#include "framework/component/parameters.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace kervan {
namespace {

/// What is wrong, and at which place inside the value: `[2]`, `.r1.start`; empty for the value itself.
struct Trouble {
  std::string where;
  std::string message;
};

std::string joined(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

std::optional<double> as_number(const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
  return std::nullopt;
}

std::string unit_of(const ParameterInfo& info) { return info.kind == ParameterKind::duration ? "s" : info.unit; }

std::string with_unit(std::string text, const std::string& unit) { return unit.empty() ? text : text + " " + unit; }

/// "0 .. 5 m/s", "at least 0 m", "at most 3".
std::string range_text(const ParameterInfo& info) {
  const std::string low = to_text(Value(info.min)), high = to_text(Value(info.max));
  if (std::isinf(info.max)) return with_unit("at least " + low, unit_of(info));
  if (std::isinf(info.min)) return with_unit("at most " + high, unit_of(info));
  return with_unit(low + " .. " + high, unit_of(info));
}

std::optional<Trouble> check(const ParameterInfo& info, const Value& value);

Trouble wrong_type(const ParameterInfo& info, const Value& value) {
  return {"", "expected " + to_text(info.kind) + ", found " + to_text(value)};
}

std::optional<Trouble> check_number(const ParameterInfo& info, const Value& value) {
  const auto number = info.kind == ParameterKind::integer && !std::holds_alternative<std::int64_t>(value)
                          ? std::nullopt
                          : as_number(value);
  if (!number) return wrong_type(info, value);
  if (std::isnan(*number)) return Trouble{"", "is not a number (NaN)"};
  if (*number >= info.min && *number <= info.max) return std::nullopt;
  return Trouble{"", with_unit(to_text(value), unit_of(info)) + " is out of range; allowed: " + range_text(info)};
}

std::optional<Trouble> check_choice(const ParameterInfo& info, const Value& value) {
  const auto* word = std::get_if<std::string>(&value);
  if (word == nullptr) return wrong_type(info, value);
  if (std::find(info.choices.begin(), info.choices.end(), *word) != info.choices.end()) return std::nullopt;
  const auto near = nearest(*word, info.choices);
  return Trouble{
      "", to_text(value) + " is not one of " + joined(info.choices) + (near ? "; did you mean '" + *near + "'?" : "")};
}

/// Every item of a list as `kind`; `count` items if it is not 0.
std::optional<Trouble> check_items(const ParameterInfo& info, const Value& value, ParameterKind kind,
                                   std::size_t count) {
  const auto* list = std::get_if<ValueList>(&value);
  if (list == nullptr || (count != 0 && list->size() != count)) return wrong_type(info, value);
  ParameterInfo item = info;
  item.kind = kind;
  for (std::size_t i = 0; i < list->size(); ++i)
    if (auto trouble = check(item, (*list)[i]))
      return Trouble{"[" + std::to_string(i) + "]" + trouble->where, trouble->message};
  return std::nullopt;
}

/// A list of lists of two. Ranges and units are those of a single coordinate.
std::optional<Trouble> check_tuples(const ParameterInfo& info, const Value& value, ParameterKind kind) {
  const auto* list = std::get_if<ValueList>(&value);
  if (list == nullptr) return wrong_type(info, value);
  for (std::size_t i = 0; i < list->size(); ++i)
    if (auto trouble = check_items(info, (*list)[i], kind, 2))
      return Trouble{"[" + std::to_string(i) + "]" + trouble->where, trouble->message};
  return std::nullopt;
}

std::optional<Trouble> check_members(const std::vector<ParameterInfo>& schema, const ValueMap& values, bool complete) {
  std::vector<std::string> names;
  for (const ParameterInfo& info : schema) names.push_back(info.name);
  for (const auto& [name, value] : values) {
    const auto info =
        std::find_if(schema.begin(), schema.end(), [&](const ParameterInfo& i) { return i.name == name; });
    if (info == schema.end()) {
      const auto near = nearest(name, names);
      return Trouble{"." + name, "there is no such parameter" +
                                     (near ? "; did you mean '" + *near + "'?" : std::string()) +
                                     (near ? " allowed: " : "; allowed: ") + joined(names)};
    }
    if (value.empty()) {
      if (info->required) return Trouble{"." + name, "is missing: " + info->help};
      continue;
    }
    if (auto trouble = check(*info, value)) return Trouble{"." + name + trouble->where, trouble->message};
  }
  for (const ParameterInfo& info : schema)
    if (complete && info.required && !values.contains(info.name))
      return Trouble{"." + info.name, "is missing: " + info.help};
  return std::nullopt;
}

std::optional<Trouble> check_records(const ParameterInfo& info, const Value& value) {
  const auto* records = std::get_if<ValueMap>(&value);
  if (records == nullptr) return wrong_type(info, value);
  for (const auto& [name, record] : *records) {
    const auto* members = std::get_if<ValueMap>(&record);
    if (members == nullptr) return Trouble{"." + name, "expected a map, found " + to_text(record)};
    if (auto trouble = check_members(info.members, *members, true))
      return Trouble{"." + name + trouble->where, trouble->message};
  }
  return std::nullopt;
}

std::optional<Trouble> check(const ParameterInfo& info, const Value& value) {
  switch (info.kind) {
    case ParameterKind::boolean:
      if (std::holds_alternative<bool>(value)) return std::nullopt;
      return wrong_type(info, value);
    case ParameterKind::integer:
    case ParameterKind::number:
    case ParameterKind::duration: return check_number(info, value);
    case ParameterKind::text:
      if (std::holds_alternative<std::string>(value)) return std::nullopt;
      return wrong_type(info, value);
    case ParameterKind::path: {
      const auto* path = std::get_if<std::string>(&value);
      if (path == nullptr) return wrong_type(info, value);
      if (path->empty()) return Trouble{"", "the name of the file is empty"};
      return std::nullopt;
    }
    case ParameterKind::choice: return check_choice(info, value);
    case ParameterKind::numbers: return check_items(info, value, ParameterKind::number, 0);
    case ParameterKind::texts: return check_items(info, value, ParameterKind::text, 0);
    case ParameterKind::pose: return check_items(info, value, ParameterKind::number, 3);
    case ParameterKind::points: return check_tuples(info, value, ParameterKind::number);
    case ParameterKind::pairs: return check_tuples(info, value, ParameterKind::integer);
    case ParameterKind::records: return check_records(info, value);
  }
  return std::nullopt;
}

/// Edits (insert, delete, replace, swap two neighbours) from `a` to `b`, capitals ignored.
std::size_t edits(const std::string& a, const std::string& b) {
  const auto same = [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  };
  std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) cost[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) cost[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      cost[i][j] =
          std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + (same(a[i - 1], b[j - 1]) ? 0 : 1)});
      if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]))
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  }
  return cost[a.size()][b.size()];
}

}  // namespace

std::string to_text(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::boolean: return "true or false";
    case ParameterKind::integer: return "integer";
    case ParameterKind::number: return "number";
    case ParameterKind::duration: return "duration";
    case ParameterKind::text: return "text";
    case ParameterKind::choice: return "choice";
    case ParameterKind::path: return "path of a file";
    case ParameterKind::numbers: return "list of numbers";
    case ParameterKind::texts: return "list of texts";
    case ParameterKind::pose: return "[x, y, yaw]";
    case ParameterKind::points: return "list of [x, y]";
    case ParameterKind::pairs: return "list of [i, j]";
    case ParameterKind::records: return "map of records";
  }
  return "";
}

std::optional<std::string> refusal(const ParameterInfo& info, const Value& value) {
  const auto trouble = check(info, value);
  if (!trouble) return std::nullopt;
  if (trouble->where.empty()) return trouble->message;
  return trouble->where.substr(trouble->where.front() == '.' ? 1 : 0) + ": " + trouble->message;
}

void validate(const std::vector<ParameterInfo>& schema, const ValueMap& values, bool complete) {
  if (const auto trouble = check_members(schema, values, complete))
    throw ParameterError(trouble->where.substr(1), trouble->message);
}

void require_live(const std::vector<ParameterInfo>& schema, const ValueMap& changes) {
  std::vector<std::string> live;
  for (const ParameterInfo& info : schema)
    if (info.live) live.push_back(info.name);
  for (const auto& [name, value] : changes)
    if (std::find(live.begin(), live.end(), name) == live.end())
      throw ParameterError(name, "cannot be changed while the component runs; " +
                                     (live.empty() ? "it has no live parameters" : "live are: " + joined(live)));
}

std::optional<std::string> nearest(const std::string& word, const std::vector<std::string>& known) {
  std::optional<std::string> best;
  std::size_t fewest = std::max<std::size_t>(1, (word.size() + 2) / 3) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edits(word, candidate);
    if (distance >= fewest || distance >= candidate.size()) continue;  // nothing of the word would be left
    fewest = distance;
    best = candidate;
  }
  return best;
}

namespace detail {
namespace {

template <class Items, class Convert>
ValueList list_of(const Items& items, Convert convert) {
  ValueList list;
  list.reserve(items.size());
  for (const auto& item : items) list.push_back(convert(item));
  return list;
}

double number_in(const Value& value) { return as_number(value).value(); }

}  // namespace

Value to_value(bool v) { return v; }
Value to_value(std::int64_t v) { return v; }
Value to_value(double v) { return v; }
Value to_value(Duration v) { return seconds(v); }
Value to_value(const std::string& v) { return v; }
Value to_value(const FilePath& v) { return v.path; }
Value to_value(const std::vector<double>& v) {
  return list_of(v, [](double item) { return Value(item); });
}
Value to_value(const std::vector<std::string>& v) {
  return list_of(v, [](const std::string& item) { return Value(item); });
}
Value to_value(const geometry::Pose2& v) { return ValueList{v.x, v.y, v.yaw}; }
Value to_value(const std::vector<geometry::Vector2>& v) {
  return list_of(v, [](const geometry::Vector2& item) { return Value(ValueList{item.x(), item.y()}); });
}
Value to_value(const std::vector<IndexPair>& v) {
  return list_of(v, [](const IndexPair& item) { return Value(ValueList{item.first, item.second}); });
}

void from_value(const Value& value, bool& v) { v = std::get<bool>(value); }
void from_value(const Value& value, std::int64_t& v) { v = std::get<std::int64_t>(value); }
void from_value(const Value& value, double& v) { v = number_in(value); }
void from_value(const Value& value, Duration& v) { v = from_seconds(number_in(value)); }
void from_value(const Value& value, std::string& v) { v = std::get<std::string>(value); }
void from_value(const Value& value, FilePath& v) { v.path = std::get<std::string>(value); }
void from_value(const Value& value, std::vector<double>& v) {
  v.clear();
  for (const Value& item : std::get<ValueList>(value)) v.push_back(number_in(item));
}
void from_value(const Value& value, std::vector<std::string>& v) {
  v.clear();
  for (const Value& item : std::get<ValueList>(value)) v.push_back(std::get<std::string>(item));
}
void from_value(const Value& value, geometry::Pose2& v) {
  const auto& list = std::get<ValueList>(value);
  v = {number_in(list.at(0)), number_in(list.at(1)), number_in(list.at(2))};
}
void from_value(const Value& value, std::vector<geometry::Vector2>& v) {
  v.clear();
  for (const Value& item : std::get<ValueList>(value)) {
    const auto& point = std::get<ValueList>(item);
    v.emplace_back(number_in(point.at(0)), number_in(point.at(1)));
  }
}
void from_value(const Value& value, std::vector<IndexPair>& v) {
  v.clear();
  for (const Value& item : std::get<ValueList>(value)) {
    const auto& pair = std::get<ValueList>(item);
    v.emplace_back(std::get<std::int64_t>(pair.at(0)), std::get<std::int64_t>(pair.at(1)));
  }
}

}  // namespace detail
}  // namespace kervan
