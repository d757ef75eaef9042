/// A picture of a place: a raster of solid and free cells.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/shapes.hpp"

namespace kervan::sim {

/// A solid cell is a solid rectangle, edges included. What lies outside of the raster is free.
struct Bitmap {
  Pose2 origin;                    ///< of the lower left corner in map; columns run along its x axis, rows along y
  Vector2 cell = Vector2::Zero();  ///< extent of a cell, m
  int columns = 0;
  int rows = 0;
  std::vector<std::uint8_t> solid;  ///< row by row from the lowest one; 0 is free

  bool is_solid(int column, int row) const {
    return column >= 0 && row >= 0 && column < columns && row < rows &&
           solid[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                 static_cast<std::size_t>(column)] != 0;
  }
};

/// The most cells a bitmap may have: its tables take 4 bytes for each.
inline constexpr std::int64_t most_cells = 100'000'000;

/// Throws std::invalid_argument with one sentence that says what cannot be.
void require_valid(const Bitmap& bitmap);

/// The borders between solid and free cells as segments in map, as long as they run straight. Those that meet in a
/// corner have exactly the same end there.
std::vector<Segment> outer_edges(const Bitmap& bitmap);

}  // namespace kervan::sim
