/// Arguments of a composition and parameters of its templates: declared alike, and put in for `${name}`.
#pragma once

#include <string>
#include <vector>

#include "deploy/composition/composition.hpp"

namespace kervan::composition {

/// A map of declarations: `drift: {type: number, default: 0.002, range: [0, 0.1], help: …}`. Defaults are checked.
std::vector<Argument> declare_arguments(const config::Node& declarations);

/// Gives an argument its value after checking it against its declaration.
void give(Argument& argument, const config::Node& value);

/// Gives each value to the argument of its node's name. Throws ConfigError at the node for an unknown name or a wrong
/// value; `of` says whose arguments they are.
void give_values(std::vector<Argument>& arguments, const std::vector<config::Node>& values, const std::string& of);

/// The values of `--arg name=value`. Throws ConfigError for an unknown name, one given twice, a wrong value, or if one
/// is left without.
void give_from_command_line(std::vector<Argument>& arguments, const std::vector<std::string>& given);

/// The node with every `${name}` in its scalars replaced. A scalar that is nothing but `${name}` takes the whole value,
/// list or not; inside of a longer text the value must be a scalar. Keys are left alone and may not hold `${`.
config::Node substitute(const config::Node& node, const std::vector<Argument>& arguments);

}  // namespace kervan::composition
