/// The ports with which a component gives away its map.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "components/grid/cells.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "kervan_msgs/msg/MapRequest.hpp"
#include "kervan_msgs/msg/MapTile.hpp"
#include "nav_msgs/msg/OccupancyGrid.hpp"

namespace kervan::mapping {

/// A map (SonarMapper, LaserMapper, MapMerger) as tiles, of which only those travel that have changed, and as a whole
/// when somebody asks for it.
class MapPorts {
 public:
  explicit MapPorts(Component* owner)
      : tiles_(owner, "tiles", qos::latched, "Tiles of the map that have changed; a late joiner gets one of each."),
        map_(owner, "map", qos::latched, "The whole map, when it was asked for."),
        request_(owner, "map_request", qos::event.optional(), "Asks for the whole map.") {}

  /// The component's life has begun: its tiles say so.
  void begin(Time now) { session_ = static_cast<std::uint64_t>(now.time_since_epoch().count()); }

  /// The tiles whose cells look different from what was published, and the whole map if it was asked for.
  template <class Map>
  void publish(Map& map, Time now, const std::string& frame) {
    for (const grid::Cell& tile : map.take_touched()) publish_tile(map, tile, now, frame);
    if (!request_.take().empty()) publish_map(map, now, frame);
  }

  std::uint64_t published() const { return revision_; }  ///< tiles so far

 private:
  template <class Map>
  void publish_tile(const Map& map, const grid::Cell& tile, Time now, const std::string& frame) {
    auto message = tiles_.loan_uncleared();
    message->data.resize(std::size_t{grid::tile_side} * grid::tile_side);
    map.read_percent(grid::cells_of_tile(tile), message->data);
    // Readings that change nothing any more, as those of a robot that stands, are not worth a message.
    const std::uint64_t looks = hash_of(message->data);
    const auto last = looks_.find(tile);
    if (last == looks_.end() ? all_unknown(message->data) : last->second == looks) return;
    looks_[tile] = looks;
    geometry::set_header(message->header, now, frame);
    message->tile_x = tile.x;
    message->tile_y = tile.y;
    message->session = session_;
    message->revision = ++revision_;
    message->resolution = static_cast<float>(map.resolution());
    message->width = message->height = static_cast<std::uint32_t>(grid::tile_side);
    tiles_.publish(std::move(message));
  }

  template <class Map>
  void publish_map(const Map& map, Time now, const std::string& frame) {
    const grid::CellBox box = map.box();
    auto message = map_.loan_uncleared();
    geometry::set_header(message->header, now, frame);
    message->info.map_load_time = geometry::to_message(now);
    message->info.resolution = static_cast<float>(map.resolution());
    message->info.width = static_cast<std::uint32_t>(box.columns);
    message->info.height = static_cast<std::uint32_t>(box.rows);
    message->info.origin =
        geometry::to_message(geometry::Pose2{box.x * map.resolution(), box.y * map.resolution(), 0.0});
    message->data.resize(std::size_t{message->info.width} * message->info.height);
    if (!box.empty()) map.read_percent(box, message->data);
    map_.publish(std::move(message));
  }

  static bool all_unknown(const std::vector<std::int8_t>& data) {
    return std::all_of(data.begin(), data.end(), [](std::int8_t percent) { return percent < 0; });
  }

  /// FNV-1a over eight cells at a time.
  static std::uint64_t hash_of(const std::vector<std::int8_t>& data) {
    std::uint64_t sum = 0xcbf29ce484222325u;
    for (std::size_t i = 0; i + 8 <= data.size(); i += 8) {
      std::uint64_t eight;
      std::memcpy(&eight, data.data() + i, 8);
      sum = (sum ^ eight) * 0x100000001b3u;
      sum ^= sum >> 32;
    }
    return sum;
  }

  Output<kervan_msgs::msg::MapTile> tiles_;
  Output<nav_msgs::msg::OccupancyGrid> map_;
  Input<kervan_msgs::msg::MapRequest> request_;
  std::map<grid::Cell, std::uint64_t> looks_;  // of each tile when it was published last
  std::uint64_t session_ = 0;
  std::uint64_t revision_ = 0;
};

}  // namespace kervan::mapping
