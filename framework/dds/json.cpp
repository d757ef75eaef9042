#include "framework/dds/json.hpp"

#include <charconv>
#include <cmath>

namespace kervan::json {
namespace {

template <class T>
void add_number(std::string& out, T value) {
  char digits[32];  // the longest double has 24 characters
  const auto result = std::to_chars(digits, digits + sizeof digits, value);
  out.append(digits, result.ptr);
}

bool is_continuation(unsigned char c) { return (c & 0xc0U) == 0x80U; }

/// The length of the UTF-8 character at the front of `text`, 0 if there is none: also for surrogates, for characters
/// beyond U+10FFFF and for those written longer than need be.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const auto continued = [&](std::size_t i) { return is_continuation(static_cast<unsigned char>(byte(i))); };
  const unsigned first = byte(0);
  if (first < 0x80U) return 1;
  if (first >= 0xc2U && first <= 0xdfU) return continued(1) ? 2 : 0;
  if (first >= 0xe0U && first <= 0xefU) {
    if (!continued(1) || !continued(2)) return 0;
    if (first == 0xe0U && byte(1) < 0xa0U) return 0;
    if (first == 0xedU && byte(1) > 0x9fU) return 0;
    return 3;
  }
  if (first >= 0xf0U && first <= 0xf4U) {
    if (!continued(1) || !continued(2) || !continued(3)) return 0;
    if (first == 0xf0U && byte(1) < 0x90U) return 0;
    if (first == 0xf4U && byte(1) > 0x8fU) return 0;
    return 4;
  }
  return 0;
}

void add_escaped(std::string& out, char c) {
  switch (c) {
    case '"': out += "\\\""; return;
    case '\\': out += "\\\\"; return;
    case '\n': out += "\\n"; return;
    case '\r': out += "\\r"; return;
    case '\t': out += "\\t"; return;
    default: break;
  }
  const auto code = static_cast<unsigned char>(c);
  if (code >= 0x20U && code != 0x7fU) {
    out += c;
    return;
  }
  static constexpr char hex[] = "0123456789abcdef";
  out += "\\u00";
  out += hex[code >> 4U];
  out += hex[code & 0xfU];
}

}  // namespace

void add(std::string& out, std::string_view value) {
  out += '"';
  while (!value.empty()) {
    const std::size_t length = character_length(value);
    if (length == 0) {
      out += "\xef\xbf\xbd";  // U+FFFD
      value.remove_prefix(1);
    } else if (length == 1) {
      add_escaped(out, value.front());
      value.remove_prefix(1);
    } else {
      out += value.substr(0, length);
      value.remove_prefix(length);
    }
  }
  out += '"';
}

void add(std::string& out, bool value) { out += value ? "true" : "false"; }
void add(std::string& out, long long value) { add_number(out, value); }
void add(std::string& out, unsigned long long value) { add_number(out, value); }

void add(std::string& out, float value) {
  if (std::isfinite(value)) {
    add_number(out, value);
  } else {
    out += "null";
  }
}

void add(std::string& out, double value) {
  if (std::isfinite(value)) {
    add_number(out, value);
  } else {
    out += "null";
  }
}

}  // namespace kervan::json
