/// Grid maps as ROS keeps them: a YAML file of map_server with a picture beside it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/config/node.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::map_file {

/// How map_server reads a shade. `trinary`: occupied, free or unknown by the two thresholds; `scale`: in between a
/// probability; `raw`: the shade is the probability in per cent, above 100 unknown.
enum class Mode { trinary, scale, raw };

struct GridMap {
  geometry::Pose2 origin;   ///< of the lower left corner in map; columns run along its x axis, rows along y
  double resolution = 0.0;  ///< m, side of a cell
  int columns = 0;
  int rows = 0;
  std::vector<std::int8_t> occupancy;  ///< row by row from the lowest one: 0 .. 100 per cent occupied, -1 unknown
  double occupied_above = 65.0;        ///< per cent; what is above counts as an obstacle
};

/// Metres from the origin of map that a map's corner may be away: more than any building.
inline constexpr double farthest_corner = 1e6;

/// Reads a map by the rules of map_server: image, resolution, origin (with yaw), negate, occupied_thresh, free_thresh
/// and mode. Transparent pixels are unknown. `folder` is where the file lies; the picture's path counts from there.
/// Throws ConfigError at the place in the file that cannot be used.
GridMap parse(const config::Node& file, const std::string& folder);

/// The same from the file's path.
GridMap load(const std::string& path);

enum class Format { png, pgm };

/// Writes `path` (which ends with .yaml) and beside it the picture of the same name; each is replaced as a whole, the
/// picture first. `trinary` is what map_saver writes: black, white and grey; `raw` keeps every percentage. Throws
/// std::invalid_argument, with the path, if a file cannot be written or the map has no cells.
void save(const GridMap& map, const std::string& path, Mode mode, Format format = Format::png);

/// Replaces `path` by a file with these bytes: it is written beside it, made durable (fsync) and renamed, so that a
/// reader, or whoever comes after a crash, finds the old file or the new one, whole. Throws std::invalid_argument with
/// the path.
void replace_file(const std::string& path, const std::string& bytes);

}  // namespace kervan::map_file
