/// Worlds as people write them: sim/README.md describes the format, sim/worlds/lab.yaml is an example.
#pragma once

#include <string>

#include "sim/world.hpp"

namespace kervan::sim {

/// Reads a world, or a map of ROS (YAML) or ARIA (.map) as one. Throws ConfigError at the place in the file that cannot
/// be used.
World load_world(const std::string& path);

/// A world from a text in memory; `shown_as` stands where messages name the file, and other files that the world names
/// lie in its folder.
World parse_world(const std::string& text, const std::string& shown_as);

}  // namespace kervan::sim
