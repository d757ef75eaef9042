/// Tiles of a map as they travel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "components/grid/occupancy.hpp"

namespace kervan::grid {

/// A square of a mapper's map.
struct TileView {
  Cell tile;
  std::uint64_t session = 0;  ///< which life of the mapper made it
  double resolution = 0.0;    ///< m
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  std::span<const std::int8_t> percent;  ///< row by row from the lowest one; -1 unknown
};

enum class TileFault {
  none,
  resolution,  ///< its cells are not of the map's size
  size,        ///< it has not as many cells as a tile has
  value,       ///< a percentage that is none
  place,       ///< so far away that its cells have no numbers
};

/// What keeps a tile out of a map whose cells have sides of `resolution`, m.
inline TileFault fault_of(const TileView& tile, double resolution) {
  constexpr auto side = static_cast<std::uint32_t>(tile_side);
  constexpr int farthest = 1 << 24;
  // As a float carries it, 0.05 is not 0.05.
  if (!(std::abs(tile.resolution - resolution) <= 1e-6 * resolution)) return TileFault::resolution;
  if (tile.columns != side || tile.rows != side || tile.percent.size() != std::size_t{side} * side)
    return TileFault::size;
  if (std::any_of(tile.percent.begin(), tile.percent.end(), [](std::int8_t p) { return p < -1 || p > 100; }))
    return TileFault::value;
  if (std::abs(std::int64_t{tile.tile.x}) > farthest || std::abs(std::int64_t{tile.tile.y}) > farthest)
    return TileFault::place;
  return TileFault::none;
}

/// Puts a tile without a fault into a map. Refused, and nothing has changed, if the map has no memory for it.
inline Growth put(const TileView& tile, Occupancy& map) {
  const CellBox box = cells_of_tile(tile.tile);
  const Growth growth = map.cover(box);
  if (growth == Growth::refused) return growth;
  for (int row = 0; row < box.rows; ++row)
    std::copy_n(tile.percent.begin() + std::ptrdiff_t{row} * box.columns, box.columns, map.place({box.x, box.y + row}));
  return growth;
}

}  // namespace kervan::grid
