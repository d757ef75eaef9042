#include "framework/config/quantity.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

namespace kervan::config {
namespace {

struct Unit {
  std::string_view name;
  double factor;  ///< multiply by it to get the SI unit
};

struct Dimension {
  std::string_view si;
  std::string_view what;  ///< "is not a length"
  std::vector<Unit> units;
};

constexpr double degree = std::numbers::pi / 180.0;

const std::vector<Dimension>& dimensions() {
  static const std::vector<Dimension> table = {
      {"m", "a length", {{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}, {"km", 1e3}}},
      {"s", "a time", {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}, {"min", 60.0}}},
      {"Hz", "a rate", {{"Hz", 1.0}, {"kHz", 1e3}}},
      {"rad", "an angle", {{"rad", 1.0}, {"deg", degree}}},
      {"m/s", "a speed", {{"m/s", 1.0}, {"cm/s", 1e-2}, {"mm/s", 1e-3}, {"km/h", 1.0 / 3.6}}},
      {"m/s2", "an acceleration", {{"m/s2", 1.0}, {"m/s^2", 1.0}, {"cm/s2", 1e-2}, {"mm/s2", 1e-3}}},
      {"rad/s", "an angular speed", {{"rad/s", 1.0}, {"deg/s", degree}}},
      {"rad/s2", "an angular acceleration", {{"rad/s2", 1.0}, {"rad/s^2", 1.0}, {"deg/s2", degree}}},
      {"kg", "a mass", {{"kg", 1.0}, {"g", 1e-3}}},
      {"N", "a force", {{"N", 1.0}}},
      {"V", "a voltage", {{"V", 1.0}, {"mV", 1e-3}}},
      {"1/s", "a gain", {{"1/s", 1.0}}},
      {"1/m", "a gain", {{"1/m", 1.0}}},
      {"m2", "an area", {{"m2", 1.0}, {"m^2", 1.0}, {"cm2", 1e-4}}},
      {"B", "a size", {{"B", 1.0}, {"kB", 1e3}, {"MB", 1e6}, {"KiB", 1024.0}, {"MiB", 1048576.0}}},
      {"B/s", "a data rate", {{"B/s", 1.0}, {"kB/s", 1e3}, {"MB/s", 1e6}}},
      {"bit/s", "a bit rate", {{"bit/s", 1.0}, {"kbit/s", 1e3}, {"Mbit/s", 1e6}, {"Gbit/s", 1e9}}},
      {"%", "a share", {{"%", 1.0}}},
  };
  return table;
}

/// A unit outside the table is a dimension of its own.
Dimension dimension_of(std::string_view si) {
  for (const Dimension& dimension : dimensions())
    if (dimension.si == si) return dimension;
  return {si, "a quantity in this unit", {{si, 1.0}}};
}

std::string quoted(std::string_view text) { return "'" + std::string(text) + "'"; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Length of the decimal number at the front of `text` (sign, digits, fraction, exponent), 0 if there is none. Unlike
/// strtod it knows no hexadecimal, infinity or NaN.
std::size_t number_length(std::string_view text) {
  std::size_t at = 0;
  const auto digits = [&] {
    const std::size_t begin = at;
    while (at < text.size() && is_digit(text[at])) ++at;
    return at - begin;
  };
  if (at < text.size() && (text[at] == '-' || text[at] == '+')) ++at;
  std::size_t count = digits();
  if (at < text.size() && text[at] == '.') {
    ++at;
    count += digits();
  }
  if (count == 0) return 0;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    const std::size_t before = at++;
    if (at < text.size() && (text[at] == '-' || text[at] == '+')) ++at;
    if (digits() == 0) at = before;  // the e belongs to a unit
  }
  return at;
}

bool has_leading_zero(std::string_view number) {
  if (!number.empty() && (number[0] == '-' || number[0] == '+')) number.remove_prefix(1);
  return number.size() > 1 && number[0] == '0' && is_digit(number[1]);
}

std::variant<double, std::string> value_of(std::string_view number) {
  if (has_leading_zero(number))
    return quoted(number) + " begins with a zero, which some read as octal; write it without";
  if (number[0] == '+') number.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(value))
    return std::string(number) + " is too large or too small for a number";
  return value;
}

std::string unit_list(const Dimension& dimension) {
  std::string list;
  for (const Unit& unit : dimension.units) {
    if (unit.name.find('^') != std::string_view::npos) continue;  // an alias
    if (!list.empty()) list += ", ";
    list += unit.name;
  }
  return list;
}

}  // namespace

std::vector<std::string> units_of(std::string_view si) {
  std::vector<std::string> names;
  for (const Unit& unit : dimension_of(si).units) names.emplace_back(unit.name);
  return names;
}

std::variant<double, std::string> parse_number(std::string_view text) {
  text = trimmed(text);
  const std::size_t length = number_length(text);
  if (length == 0) return quoted(text) + " is not a number";
  const std::string_view rest = trimmed(text.substr(length));
  if (!rest.empty()) {
    for (const Dimension& dimension : dimensions())
      for (const Unit& unit : dimension.units)
        if (unit.name == rest)
          return quoted(text) + " has a unit, but this is a plain number; write " + std::string(text.substr(0, length));
    return quoted(text) + " is not a number";
  }
  return value_of(text);
}

std::variant<double, std::string> parse_quantity(std::string_view text, std::string_view si) {
  if (si.empty()) return parse_number(text);
  const Dimension dimension = dimension_of(si);
  text = trimmed(text);
  const std::size_t length = number_length(text);
  const std::string_view number = text.substr(0, length);
  const std::string_view unit = trimmed(text.substr(length));
  if (length == 0)
    return quoted(text) + " is not " + std::string(dimension.what) + "; write a number and a unit, e.g. 1 " +
           std::string(si);
  const auto value = value_of(number);
  if (!std::holds_alternative<double>(value)) return value;
  if (unit.empty())
    return std::string(number) + " has no unit; write e.g. " + std::string(number) + " " + std::string(si);
  for (const Unit& known : dimension.units) {
    if (known.name != unit) continue;
    const double in_si = std::get<double>(value) * known.factor;
    if (!std::isfinite(in_si)) return std::string(text) + " is too large or too small for a number";
    return in_si;
  }
  return std::string(text) + " is not " + std::string(dimension.what) + "; allowed units: " + unit_list(dimension);
}

}  // namespace kervan::config
