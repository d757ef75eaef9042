/// What rays over bitmaps are measured against: the textbook's walk from cell to cell.
#pragma once

#include <cstdint>
#include <vector>

namespace kervan::bench {

/// A raster of solid (not 0) and free cells, row by row; the cells of its border are solid.
struct Raster {
  int columns = 0;
  int rows = 0;
  std::vector<std::uint8_t> solid;
};

/// Cells along the ray from (x, y), in cells, to the first solid cell, `range` if there is none nearer. (dx, dy) has
/// length 1. Amanatides and Woo, A fast voxel traversal algorithm for ray tracing, 1987.
float walk(const Raster& raster, float x, float y, float dx, float dy, float range);

}  // namespace kervan::bench
