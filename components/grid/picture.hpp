/// Maps as pictures for people.
#pragma once

#include <string>

#include "components/grid/occupancy.hpp"

namespace kervan::grid {

struct Picture {
  CellBox box;      ///< of the cells that are drawn, a pixel each; empty if the map knows nothing
  std::string png;  ///< white where the map is free, black where it is occupied, transparent where nothing is known
};

/// The known part of a map. Throws std::invalid_argument if it has too many cells for a picture.
Picture picture_of(const Occupancy& map);

}  // namespace kervan::grid
