/// Values that whoever runs a composition gives to parameters of its components, over what the file says.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "deploy/composition/composition.hpp"

namespace kervan::composition {

/// The parts of a path with points between them.
std::vector<std::string> split_path(const std::string& path);

/// Puts `setting` where `path` leads to from `map`, in place of what is there; maps on the way are made. Throws
/// ConfigError at the setting's key if the way leads through something that is no map.
void put(config::Node& map, std::span<const std::string> path, const config::Node& setting);

/// The lines of `--set COMPONENT.params.NAME=VALUE`, each as a node whose name is the path. Throws ConfigError for one
/// that is none. A value that begins with a bracket or a brace is read as YAML.
std::vector<config::Node> settings_from_command_line(const std::vector<std::string>& given);

/// Puts each value where its name (`r1/control.params.rho0`, `world.params.robots.r1.drift`) leads to; what is not on
/// the way is made. Whether the component has the parameter is found out by resolve(). Throws ConfigError at the
/// setting for an unknown component, for a path to something else than a parameter, and if two set the same.
void apply_settings(Composition& composition, const std::vector<config::Node>& settings);

}  // namespace kervan::composition
