/// Maps of ARIA and MobileSim: a text file of lines and points ("2D-Map").
#pragma once

#include <string>

#include "sim/world.hpp"

namespace kervan::sim {

/// Reads the lines as segments and the points as the solid cells of a bitmap of the map's resolution, each point in the
/// middle of a cell. Goals, forbidden areas and whatever else is drawn in such a map are no obstacles and are passed
/// over. Throws ConfigError at the line that cannot be used, or at no line if the file cannot be read.
Obstacles load_aria_map(const std::string& path);

/// The same for a text in memory.
Obstacles parse_aria_map(const std::string& text, const std::string& shown_as);

}  // namespace kervan::sim
