#include "components/grid/picture.hpp"

#include <cmath>

#include "framework/map_file/image.hpp"

namespace kervan::grid {
namespace {

CellBox known_part(const Occupancy& map) {
  const CellBox& box = map.box();
  CellBox known;
  for (int y = box.y; y < box.y + box.rows; ++y) {
    const std::int8_t* const row = map.place({box.x, y});
    int first = 0, end = box.columns;
    while (first < end && row[first] < 0) ++first;
    while (end > first && row[end - 1] < 0) --end;
    known = united(known, {box.x + first, y, end - first, 1});
  }
  return known;
}

}  // namespace

Picture picture_of(const Occupancy& map) {
  Picture picture{known_part(map), {}};
  const CellBox& box = picture.box;
  if (box.empty()) return picture;
  map_file::Image image{box.columns, box.rows, {}};
  image.pixels.reserve(static_cast<std::size_t>(box.columns) * static_cast<std::size_t>(box.rows));
  for (int y = box.y + box.rows - 1; y >= box.y; --y)  // pictures begin at the top
    for (int x = box.x; x < box.x + box.columns; ++x) {
      const std::int8_t percent = map.at({x, y});
      const auto shade = static_cast<std::uint8_t>(std::lround(2.55 * (100 - percent)));
      image.pixels.push_back(percent < 0 ? map_file::Pixel{0, 0} : map_file::Pixel{shade, 255});
    }
  picture.png = to_png(image);
  return picture;
}

}  // namespace kervan::grid
