/// Messages for tests of components that make or keep maps.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "components/grid/cells.hpp"
#include "framework/component/sample.hpp"
#include "kervan_msgs/msg/MapTile.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {

inline nav_msgs::msg::Odometry odometry_at(Time stamp, const geometry::Pose2& pose) {
  nav_msgs::msg::Odometry message = odometry_at(pose);
  message.header.stamp = geometry::to_message(stamp);
  return message;
}

/// A tile whose first cells are these, and the rest unknown.
inline kervan_msgs::msg::MapTile map_tile(grid::Cell place, std::vector<std::int8_t> first, std::uint64_t session = 1) {
  kervan_msgs::msg::MapTile tile;
  tile.header.frame_id = "map";
  tile.tile_x = place.x;
  tile.tile_y = place.y;
  tile.session = session;
  tile.resolution = 0.05f;
  tile.width = tile.height = grid::tile_side;
  tile.data = std::move(first);
  tile.data.resize(std::size_t{grid::tile_side} * grid::tile_side, -1);
  return tile;
}

/// What somebody knows who hears the tiles.
struct TileMap {
  std::map<grid::Cell, std::vector<std::int8_t>> tiles;
  double resolution = 0.0;
  std::uint64_t session = 0;

  void take(const std::vector<Sample<kervan_msgs::msg::MapTile>>& samples) {
    for (const auto& tile : samples) {
      tiles[{tile->tile_x, tile->tile_y}] = tile->data;
      resolution = static_cast<double>(tile->resolution);
      session = tile->session;
    }
  }

  int percent(double x, double y) const {
    const grid::Cell cell = grid::cell_of({x, y}, resolution);
    const grid::Cell tile{grid::tile_of(cell.x), grid::tile_of(cell.y)};
    const auto found = tiles.find(tile);
    if (found == tiles.end()) return -1;
    const int column = cell.x - tile.x * grid::tile_side, row = cell.y - tile.y * grid::tile_side;
    return found->second[static_cast<std::size_t>(row * grid::tile_side + column)];
  }
};

}  // namespace kervan::test
