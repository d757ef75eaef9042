/// Maps as percentages: what leaves a grid, whatever its cells are.
#pragma once

#include <cstdint>
#include <span>

#include "components/grid/certainty.hpp"
#include "components/grid/grid.hpp"
#include "components/grid/log_odds.hpp"
#include "components/grid/masses.hpp"
#include "framework/map_file/map_file.hpp"

namespace kervan::grid {

/// 0 .. 100 per cent occupied, -1 unknown, as in nav_msgs/OccupancyGrid.
using Occupancy = Grid<std::int8_t>;

inline std::int8_t percent_of(std::int8_t percent) { return percent; }

/// The percentages of a rectangle of cells, row by row from the lowest one, into `percent` (as many). Cells outside of
/// the grid are unknown.
template <class Value>
void read_percent(const Grid<Value>& grid, const CellBox& box, std::span<std::int8_t> percent) {
  std::size_t i = 0;
  const bool inside = grid.box().contains(box);
  for (int row = 0; row < box.rows; ++row)
    if (inside) {
      const Value* const cells = grid.place({box.x, box.y + row});
      for (int column = 0; column < box.columns; ++column) percent[i++] = percent_of(cells[column]);
    } else {
      for (int column = 0; column < box.columns; ++column)
        percent[i++] = percent_of(grid.at({box.x + column, box.y + row}));
    }
}

/// A map of the cells as map_server keeps them. A grid without cells gives one unknown cell: a picture needs one.
template <class Value>
map_file::GridMap to_map_file(const Grid<Value>& grid) {
  const CellBox box = grid.box().empty() ? CellBox{0, 0, 1, 1} : grid.box();
  map_file::GridMap map{
      {box.x * grid.resolution(), box.y * grid.resolution(), 0.0},
      grid.resolution(),
      box.columns,
      box.rows,
      std::vector<std::int8_t>(static_cast<std::size_t>(box.columns) * static_cast<std::size_t>(box.rows))};
  read_percent(grid, box, map.occupancy);
  return map;
}

/// The cells of the grid that a map's become: the nearest ones. Throws std::invalid_argument if the map is turned
/// against its frame or too far from its origin.
CellBox cells_of(const map_file::GridMap& map);

/// The map as a grid. Its cells are moved to the nearest cells of the grid, by at most half of one. Throws
/// std::invalid_argument if cells_of() does or the map needs more than `most_bytes`.
Occupancy from_map_file(const map_file::GridMap& map, std::size_t most_bytes);

}  // namespace kervan::grid
