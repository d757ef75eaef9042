/// From what stands in a file to the values that a component's parameters take.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "framework/component/parameters.hpp"
#include "framework/config/node.hpp"

namespace kervan::config {

/// Finds the file that a path parameter names and returns its absolute path; throws ConfigError if there is none.
using FindFile = std::function<std::string(const Node& path)>;

/// The node as a value for `info`: converted to SI units, in range, one of the choices. Throws ConfigError at the very
/// item that is wrong. Without `find_file` a path stays as written.
Value to_value(const Node& node, const ParameterInfo& info, const FindFile& find_file = {});

/// A whole `params:` map. Unknown and missing parameters are refused; those not given are left out. `of` names whose
/// parameters they are ("control/vff") in messages.
ValueMap to_values(const Node& params, const std::vector<ParameterInfo>& schema, const std::string& of,
                   const FindFile& find_file = {});

}  // namespace kervan::config
