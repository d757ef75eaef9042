#include "sim/files/ros_map.hpp"

#include <filesystem>

#include "framework/map_file/map_file.hpp"

namespace kervan::sim {

Bitmap ros_map(const config::Node& file, const std::string& folder) {
  const map_file::GridMap map = map_file::parse(file, folder);
  Bitmap bitmap{map.origin, Vector2::Constant(map.resolution), map.columns, map.rows, {}};
  bitmap.solid.reserve(map.occupancy.size());
  for (const std::int8_t occupancy : map.occupancy) bitmap.solid.push_back(occupancy > map.occupied_above ? 1 : 0);
  return bitmap;
}

Bitmap load_ros_map(const std::string& path) {
  return ros_map(config::load(path), std::filesystem::path(path).parent_path().string());
}

}  // namespace kervan::sim
