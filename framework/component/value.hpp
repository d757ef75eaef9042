/// The values a composition gives to parameters, already typed and in SI units; where they came from is not known here.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace kervan {

class Value;
using ValueList = std::vector<Value>;
using ValueMap = std::map<std::string, Value>;

/// Nothing, a boolean, an integer, a number (SI unit), a text, a list or a map of values.
class Value : public std::variant<std::monostate, bool, std::int64_t, double, std::string, ValueList, ValueMap> {
 public:
  using variant::variant;
  Value(const char* text) : variant(std::string(text)) {}
  Value(int number) : variant(static_cast<std::int64_t>(number)) {}

  bool empty() const { return index() == 0; }
};

/// The value as a person would write it in a composition: `0.5`, `[1, 2]`, `{a: 1}`.
std::string to_text(const Value& value);

}  // namespace kervan
