/// How good a map is, by the simulator's truth.
#pragma once

#include <cstdint>

#include "components/grid/occupancy.hpp"
#include "components/observe/map_truth.hpp"

namespace kervan::observe {

/// A cell is judged if the map knows it and it is not hidden, or hidden and said to be free. Above 50 per cent it is
/// said to be occupied. Of the two cells beside a wall that runs along their common border one has to be. Shares are of
/// 1; NaN where there is nothing to have a share of.
struct MapQuality {
  std::uint64_t judged = 0;     ///< cells
  double accuracy = 0.0;        ///< judged cells that are what the map says
  double near_accuracy = 0.0;   ///< the same if being occupied may be off by one cell
  double false_occupied = 0.0;  ///< of the known cells that are free, those said to be occupied
  double false_free = 0.0;      ///< of the known cells that are occupied or hidden, those said to be free
  double coverage = 0.0;        ///< of all free cells, those the map knows
  double entropy_bits = 0.0;    ///< mean over the known cells: how unsure the map is
  double wall_error_m = 0.0;    ///< mean distance of the cells said to be occupied from the nearest surface
  double worst_wall_error_m = 0.0;
};

/// `map` must have the cells of `truth`: the same resolution.
MapQuality judge(const grid::Occupancy& map, const MapTruth& truth);

}  // namespace kervan::observe
