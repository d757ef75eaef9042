/// Values of parameters as a person writes them in a composition, with their units, and back.
#pragma once

#include <string>

#include "framework/component/parameters.hpp"

namespace kervan::container {

/// "0.5 m/s", "100 ms" as "0.1 s", "[1 m, 2 m]": what a composition takes for the same value. Empty for a value
/// that is not there.
std::string to_parameter_text(const ParameterInfo& info, const Value& value);

/// Throws ParameterError with the parameter's name and what is allowed.
Value parameter_from_text(const ParameterInfo& info, const std::string& text);

}  // namespace kervan::container
