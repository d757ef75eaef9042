#include "sim/bitmap.hpp"

#include <cmath>
#include <stdexcept>

namespace kervan::sim {

void require_valid(const Bitmap& bitmap) {
  if (!bitmap.origin.position().allFinite() || !std::isfinite(bitmap.origin.yaw))
    throw std::invalid_argument("a bitmap needs a finite origin");
  if (!bitmap.cell.allFinite() || !(bitmap.cell.minCoeff() > 0.0))
    throw std::invalid_argument("the cells of a bitmap need a positive extent");
  if (bitmap.columns < 1 || bitmap.rows < 1) throw std::invalid_argument("a bitmap needs cells");
  const std::int64_t cells = std::int64_t{bitmap.columns} * bitmap.rows;
  if (cells > most_cells)
    throw std::invalid_argument("a bitmap may have at most " + std::to_string(most_cells) + " cells");
  if (static_cast<std::int64_t>(bitmap.solid.size()) != cells)
    throw std::invalid_argument("a bitmap needs one value for each of its cells");
}

std::vector<Segment> outer_edges(const Bitmap& bitmap) {
  std::vector<Segment> edges;
  const auto corner = [&](int column, int row) {
    return bitmap.origin * Vector2(column * bitmap.cell.x(), row * bitmap.cell.y());
  };
  // Along each line between two rows, then between two columns: a border goes on while the same side of it is solid.
  for (int row = 0; row <= bitmap.rows; ++row)
    for (int column = 0; column < bitmap.columns;) {
      const auto side = [&](int c) { return int{bitmap.is_solid(c, row)} - int{bitmap.is_solid(c, row - 1)}; };
      const int begin = column, here = side(column);
      while (column < bitmap.columns && side(column) == here) ++column;
      if (here != 0) edges.push_back({corner(begin, row), corner(column, row)});
    }
  for (int column = 0; column <= bitmap.columns; ++column)
    for (int row = 0; row < bitmap.rows;) {
      const auto side = [&](int r) { return int{bitmap.is_solid(column, r)} - int{bitmap.is_solid(column - 1, r)}; };
      const int begin = row, here = side(row);
      while (row < bitmap.rows && side(row) == here) ++row;
      if (here != 0) edges.push_back({corner(column, begin), corner(column, row)});
    }
  return edges;
}

}  // namespace kervan::sim
