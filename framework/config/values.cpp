#include "framework/config/values.hpp"

namespace kervan::config {
namespace {

std::vector<std::string> names_of(const std::vector<ParameterInfo>& schema) {
  std::vector<std::string> names;
  for (const ParameterInfo& info : schema) names.push_back(info.name);
  return names;
}

ValueList pair_of_integers(const Node& node) {
  const auto& items = node.list_of(2, "a pair [i, j]");
  return {items[0].as_integer(), items[1].as_integer()};
}

/// Items are checked one by one, so that a refusal points at the item and not at the list.
void check(const Node& node, const ParameterInfo& info, const Value& value) {
  if (const auto trouble = refusal(info, value))
    node.fail(*trouble + (node.written.empty() ? "" : " (from " + node.written + ")"));
}

ParameterInfo item_of(const ParameterInfo& info, ParameterKind kind) {
  ParameterInfo item = info;
  item.kind = kind;
  return item;
}

}  // namespace

Value to_value(const Node& node, const ParameterInfo& info, const FindFile& find_file) {
  Value value;
  switch (info.kind) {
    case ParameterKind::boolean:
      value = node.as_bool();
      break;
    case ParameterKind::integer:
      value = node.as_integer();
      break;
    case ParameterKind::number:
      value = node.as_quantity(info.unit);
      break;
    case ParameterKind::duration:
      value = seconds(node.as_duration());
      break;
    case ParameterKind::text:
      value = node.as_text();
      break;
    case ParameterKind::choice:
      value = node.as_choice(info.choices);
      break;
    case ParameterKind::path:
      value = node.as_text();
      check(node, info, value);
      if (find_file) value = find_file(node);
      return value;
    case ParameterKind::numbers: {
      ValueList list;
      for (const Node& item : node.list()) list.push_back(to_value(item, item_of(info, ParameterKind::number)));
      value = std::move(list);
      break;
    }
    case ParameterKind::texts: {
      ValueList list;
      for (const Node& item : node.list()) list.push_back(to_value(item, item_of(info, ParameterKind::text)));
      value = std::move(list);
      break;
    }
    case ParameterKind::pose: {
      const geometry::Pose2 pose = node.as_pose();
      value = ValueList{pose.x, pose.y, pose.yaw};
      break;
    }
    case ParameterKind::points: {
      ValueList list;
      for (const Node& item : node.list()) {
        const geometry::Vector2 point = item.as_point();
        list.push_back(ValueList{point.x(), point.y()});
      }
      value = std::move(list);
      break;
    }
    case ParameterKind::pairs: {
      ValueList list;
      for (const Node& item : node.list()) list.push_back(pair_of_integers(item));
      value = std::move(list);
      break;
    }
    case ParameterKind::records: {
      ValueMap records;
      for (const Node& record : node.map())
        records[record.name] = to_values(record, info.members, info.name, find_file);
      value = std::move(records);
      break;
    }
  }
  check(node, info, value);
  return value;
}

ValueMap to_values(const Node& params, const std::vector<ParameterInfo>& schema, const std::string& of,
                   const FindFile& find_file) {
  const std::vector<std::string> known = names_of(schema);
  ValueMap values;
  for (const Node& given : params.map()) {
    const ParameterInfo* info = nullptr;
    for (const ParameterInfo& candidate : schema)
      if (candidate.name == given.name) info = &candidate;
    if (info == nullptr)
      given.fail_at_key(of + " has no parameter '" + given.name + "'" + hint(given.name, known, "it has"));
    values[given.name] = to_value(given, *info, find_file);
  }
  for (const ParameterInfo& info : schema)
    if (info.required && !values.contains(info.name))
      params.fail("the parameter '" + info.name + "' of " + of + " is missing: " + info.help);
  return values;
}

}  // namespace kervan::config
