/// JSON that another program of Kervan wrote, read strictly: every member must be there, have its type, and be known.
#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "framework/component/error.hpp"

namespace kervan::container {

/// A value and the way that leads to it ("components[2].name"), for messages. Throws ConfigError.
class JsonReader {
 public:
  JsonReader(const nlohmann::json& value, std::string file, std::string path = {})
      : value_(value), file_(std::move(file)), path_(std::move(path)) {}

  const nlohmann::json& raw() const { return value_; }

  [[noreturn]] void fail(const std::string& message) const {
    throw ConfigError({file_, 0, 0}, (path_.empty() ? "" : path_ + ": ") + message);
  }

  bool has(const char* key) const { return value_.is_object() && value_.contains(key); }

  JsonReader at(const char* key) const {
    if (!value_.is_object()) fail("must be an object");
    const auto found = value_.find(key);
    const std::string path = path_.empty() ? key : path_ + "." + key;
    if (found == value_.end()) throw ConfigError({file_, 0, 0}, path + ": is missing");
    return {*found, file_, path};
  }

  JsonReader at(std::size_t index) const {
    return {value_.at(index), file_, path_ + "[" + std::to_string(index) + "]"};
  }

  void only_keys(std::initializer_list<const char*> known) const {
    if (!value_.is_object()) fail("must be an object");
    for (const auto& item : value_.items()) {
      bool found = false;
      for (const char* key : known) found = found || item.key() == key;
      if (!found) fail("unknown key '" + item.key() + "'; this program and the one that wrote it differ");
    }
  }

  bool boolean() const {
    if (!value_.is_boolean()) fail("must be true or false");
    return value_.get<bool>();
  }

  template <class Integer>
  Integer integer() const {
    if (value_.is_number_unsigned()) {
      const auto held = value_.get<std::uint64_t>();
      if (std::in_range<Integer>(held)) return static_cast<Integer>(held);
      fail("the number is too large");
    }
    if (!value_.is_number_integer()) fail("must be an integer");
    const auto held = value_.get<std::int64_t>();
    if (!std::in_range<Integer>(held)) fail("the number is out of range");
    return static_cast<Integer>(held);
  }

  double number() const {
    if (!value_.is_number()) fail("must be a number");
    return value_.get<double>();
  }

  /// null stands for a number that JSON cannot hold.
  double number_or_nan() const { return value_.is_null() ? std::numeric_limits<double>::quiet_NaN() : number(); }

  std::string text() const {
    if (!value_.is_string()) fail("must be a text");
    return value_.get<std::string>();
  }

  std::uint64_t hash() const {
    const std::string digits = text();
    if (digits.size() != 16 || digits.find_first_not_of("0123456789abcdef") != std::string::npos)
      fail("must be 16 hexadecimal digits");
    return std::stoull(digits, nullptr, 16);
  }

  /// Calls use(reader) for every item of a list.
  template <class Use>
  void each(Use&& use) const {
    if (!value_.is_array()) fail("must be a list");
    for (std::size_t i = 0; i < value_.size(); ++i) use(at(i));
  }

 private:
  const nlohmann::json& value_;
  std::string file_;
  std::string path_;
};

/// 16 hexadecimal digits: a number of 64 bits does not survive every reader of JSON.
inline std::string hash_text(std::uint64_t value) {
  std::string digits(16, '0');
  for (std::size_t i = 16; i-- > 0; value >>= 4) digits[i] = "0123456789abcdef"[value & 15];
  return digits;
}

/// Parses a text. Throws ConfigError at line and column.
inline nlohmann::json parse_json(const std::string& text, const std::string& shown_as) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    Location at{shown_as, 1, 1};
    for (std::size_t i = 0; i + 1 < error.byte && i < text.size(); ++i) {
      at.column = text[i] == '\n' ? 1 : at.column + 1;
      at.line += text[i] == '\n';
    }
    throw ConfigError(at, "this is no JSON");
  }
}

}  // namespace kervan::container
