/// Maps of ROS: a YAML file of map_server with a picture beside it.
#pragma once

#include <string>

#include "framework/config/node.hpp"
#include "sim/bitmap.hpp"

namespace kervan::sim {

/// The map as an obstacle (map_file.hpp reads it): cells that are occupied beyond occupied_thresh are solid, all others
/// are free, unknown and transparent ones too. `folder` is where the file lies; the picture's path counts from there.
/// Throws ConfigError at the place in the file that cannot be used.
Bitmap ros_map(const config::Node& file, const std::string& folder);

/// The same from the file's path.
Bitmap load_ros_map(const std::string& path);

}  // namespace kervan::sim
