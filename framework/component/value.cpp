#include "framework/component/value.hpp"

#include <array>
#include <charconv>
#include <type_traits>

namespace kervan {
namespace {

/// The shortest text that reads back as the same number.
std::string number_text(double number) {
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  return error == std::errc() ? std::string(buffer.data(), end) : "?";
}

/// Plain where YAML reads it back as the same text, else in double quotes.
std::string word_text(const std::string& word) {
  const bool plain = !word.empty() &&
                     word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-") ==
                         std::string::npos &&
                     word.find_first_not_of("0123456789+-.") != std::string::npos && word != "true" &&
                     word != "false" && word != "null" && word.front() != '-';
  if (plain) return word;
  std::string text = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\') text += '\\';
    if (c == '\n')
      text += "\\n";
    else
      text += c;
  }
  return text + '"';
}

}  // namespace

std::string to_text(const Value& value) {
  using Variant = std::variant<std::monostate, bool, std::int64_t, double, std::string, ValueList, ValueMap>;
  return std::visit(
      [](const auto& held) -> std::string {
        using Held = std::decay_t<decltype(held)>;
        if constexpr (std::is_same_v<Held, std::monostate>)
          return "nothing";
        else if constexpr (std::is_same_v<Held, bool>)
          return held ? "true" : "false";
        else if constexpr (std::is_same_v<Held, std::int64_t>)
          return std::to_string(held);
        else if constexpr (std::is_same_v<Held, double>)
          return number_text(held);
        else if constexpr (std::is_same_v<Held, std::string>)
          return word_text(held);
        else if constexpr (std::is_same_v<Held, ValueList>) {
          std::string text;
          for (const Value& item : held) text += (text.empty() ? "" : ", ") + to_text(item);
          return "[" + text + "]";
        } else {
          std::string text;
          for (const auto& [key, item] : held) text += (text.empty() ? "" : ", ") + key + ": " + to_text(item);
          return "{" + text + "}";
        }
      },
      static_cast<const Variant&>(value));
}

}  // namespace kervan
