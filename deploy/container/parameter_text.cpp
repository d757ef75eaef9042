#include "deploy/container/parameter_text.hpp"

#include "framework/config/node.hpp"
#include "framework/config/values.hpp"

namespace kervan::container {
namespace {

std::string with_unit(const Value& value, const std::string& unit) {
  return to_text(value) + (unit.empty() ? "" : " " + unit);
}

template <class Item>
std::string list_text(const Value& value, Item&& item) {
  std::string text;
  const auto& list = std::get<ValueList>(value);
  for (std::size_t i = 0; i < list.size(); ++i) text += (i == 0 ? "" : ", ") + item(list[i], i);
  return "[" + text + "]";
}

bool is_scalar(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::boolean:
    case ParameterKind::integer:
    case ParameterKind::number:
    case ParameterKind::duration:
    case ParameterKind::text:
    case ParameterKind::choice:
    case ParameterKind::path: return true;
    default: return false;
  }
}

}  // namespace

std::string to_parameter_text(const ParameterInfo& info, const Value& value) {
  if (value.empty()) return {};
  switch (info.kind) {
    case ParameterKind::number: return with_unit(value, info.unit);
    case ParameterKind::duration: return with_unit(value, "s");
    case ParameterKind::numbers:
      return list_text(value, [&](const Value& item, std::size_t) { return with_unit(item, info.unit); });
    case ParameterKind::pose:
      return list_text(value, [](const Value& item, std::size_t i) { return with_unit(item, i == 2 ? "rad" : "m"); });
    case ParameterKind::points:
      return list_text(value, [](const Value& point, std::size_t) {
        return list_text(point, [](const Value& item, std::size_t) { return with_unit(item, "m"); });
      });
    case ParameterKind::records: {
      std::string text;
      for (const auto& [name, record] : std::get<ValueMap>(value)) {
        std::string members;
        for (const ParameterInfo& member : info.members) {
          const auto& values = std::get<ValueMap>(record);
          const auto found = values.find(member.name);
          if (found == values.end() || found->second.empty()) continue;
          members += (members.empty() ? "" : ", ") + member.name + ": " + to_parameter_text(member, found->second);
        }
        text += (text.empty() ? "" : ", ") + name + ": {" + members + "}";
      }
      return "{" + text + "}";
    }
    default: return to_text(value);
  }
}

Value parameter_from_text(const ParameterInfo& info, const std::string& text) {
  try {
    // A scalar is taken as it stands, unless it is quoted; lists and maps need the parser.
    const bool plain = is_scalar(info.kind) && !text.starts_with('"');
    const config::Node node = plain ? config::scalar(text, "", info.name) : config::parse(text, info.name);
    return config::to_value(node, info);
  } catch (const ConfigError& error) {
    throw ParameterError(info.name, error.message());
  }
}

}  // namespace kervan::container
