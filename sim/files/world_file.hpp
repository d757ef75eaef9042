/// Worlds as people write them: sim/README.md describes the format, sim/worlds/lab.yaml is an example.
#pragma once

#include <string>

#include "sim/world.hpp"

namespace kervan::sim {

/// Reads a world. Throws ConfigError at the place in the file that cannot be used.
World load_world(const std::string& path);

/// The same from a text in memory; `shown_as` stands where messages name the file.
World parse_world(const std::string& text, const std::string& shown_as);

}  // namespace kervan::sim
