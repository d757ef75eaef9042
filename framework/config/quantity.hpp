/// Numbers with units, as people write them: `50ms`, `0.05 m`, `1.5 m/s`, `30deg`.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace kervan::config {

/// The units in which a quantity with the SI unit `si` may be written, the SI unit first. A unit that the table does
/// not hold may only be written as it is.
std::vector<std::string> units_of(std::string_view si);

/// The value in SI units, or one sentence that says what is wrong with `text`.
std::variant<double, std::string> parse_quantity(std::string_view text, std::string_view si);

/// A finite decimal number without a unit; leading zeros, hexadecimal, infinity and NaN are refused with a reason.
std::variant<double, std::string> parse_number(std::string_view text);

}  // namespace kervan::config
