/// Messages as compact JSON, for people and scripts. Nothing reads it back.
#pragma once

#include <string>
#include <string_view>
#include <type_traits>

#include "framework/dds/cdr.hpp"
#include "framework/dds/message.hpp"

namespace kervan::json {

/// A JSON string. Bytes that are no UTF-8 become U+FFFD: what came from the wire need not be text.
[[gnu::visibility("default")]] void add(std::string& out, std::string_view value);

[[gnu::visibility("default")]] void add(std::string& out, bool value);
[[gnu::visibility("default")]] void add(std::string& out, long long value);
[[gnu::visibility("default")]] void add(std::string& out, unsigned long long value);

/// The shortest digits that read back as the same number; NaN and the infinities, which JSON lacks, are null.
[[gnu::visibility("default")]] void add(std::string& out, float value);
[[gnu::visibility("default")]] void add(std::string& out, double value);

/// Any member or message. An enum is its enumerator's name, or its number if there is none.
template <class T>
void add_value(std::string& out, const T& value) {
  if constexpr (std::is_same_v<T, bool> || std::is_floating_point_v<T>) {
    add(out, value);
  } else if constexpr (std::is_unsigned_v<T>) {
    add(out, static_cast<unsigned long long>(value));
  } else if constexpr (std::is_integral_v<T>) {
    add(out, static_cast<long long>(value));
  } else if constexpr (std::is_enum_v<T>) {
    if (is_valid(value)) {
      add(out, to_string(value));
    } else {
      add(out, static_cast<long long>(value));
    }
  } else if constexpr (std::is_same_v<T, std::string>) {
    add(out, std::string_view(value));
  } else if constexpr (Message<const T>) {
    char separator = '{';
    fields(
        [&](const Field& field, const auto& member) {
          out += separator;
          separator = ',';
          add(out, std::string_view(field.name));
          out += ':';
          add_value(out, member);
        },
        value);
    out += '}';
  } else {
    out += '[';
    bool first = true;
    for (const auto& element : value) {
      if (!first) out += ',';
      first = false;
      add_value(out, element);
    }
    out += ']';
  }
}

}  // namespace kervan::json
