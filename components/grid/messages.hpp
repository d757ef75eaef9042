/// Tiles as messages.
#pragma once

#include "components/grid/tile.hpp"
#include "kervan_msgs/msg/MapTile.hpp"

namespace kervan::grid {

/// A view of `message`, which must outlive it.
inline TileView view_of(const kervan_msgs::msg::MapTile& message) {
  return {{message.tile_x, message.tile_y},
          message.session,
          static_cast<double>(message.resolution),
          message.width,
          message.height,
          message.data};
}

}  // namespace kervan::grid
