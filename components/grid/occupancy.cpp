#include "components/grid/occupancy.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace kervan::grid {

CellBox cells_of(const map_file::GridMap& map) {
  if (map.origin.yaw != 0.0)
    throw std::invalid_argument("the map is turned by " + std::to_string(map.origin.yaw) +
                                " rad against its frame; allowed: 0");
  const geometry::Vector2 corner = map.origin.position() / map.resolution;
  if (!has_cell(corner)) throw std::invalid_argument("the map's corner is too far from the origin of its frame");
  return {static_cast<int>(std::lround(corner.x())), static_cast<int>(std::lround(corner.y())), map.columns, map.rows};
}

Occupancy from_map_file(const map_file::GridMap& map, std::size_t most_bytes) {
  const CellBox box = cells_of(map);
  Occupancy grid(map.resolution, std::int8_t{-1}, most_bytes);
  if (grid.cover(box) == Growth::refused)
    throw std::invalid_argument("the map of " + std::to_string(map.columns) + " x " + std::to_string(map.rows) +
                                " cells needs more than the allowed " + std::to_string(most_bytes) + " bytes");
  for (int row = 0; row < box.rows; ++row)
    std::copy_n(map.occupancy.begin() + std::ptrdiff_t{row} * box.columns, box.columns,
                grid.place({box.x, box.y + row}));
  grid.touch(box);
  return grid;
}

}  // namespace kervan::grid
