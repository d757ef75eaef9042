/// Cells of the plane and rectangles of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdint>

#include "framework/geometry/pose2.hpp"

namespace kervan::grid {

/// Cell (0, 0) has its lower left corner in the origin of the map's frame; x counts along the frame's x axis.
struct Cell {
  int x = 0;
  int y = 0;

  auto operator<=>(const Cell&) const = default;
};

/// A rectangle of cells, from its lower left one.
struct CellBox {
  int x = 0;
  int y = 0;
  int columns = 0;
  int rows = 0;

  bool empty() const { return columns <= 0 || rows <= 0; }
  bool contains(const Cell& cell) const {
    return cell.x >= x && cell.y >= y && cell.x - x < columns && cell.y - y < rows;
  }
  bool contains(const CellBox& other) const {
    return other.empty() ||
           (other.x >= x && other.y >= y && other.x + other.columns <= x + columns && other.y + other.rows <= y + rows);
  }
  CellBox moved_by(const Cell& by) const { return {x + by.x, y + by.y, columns, rows}; }

  bool operator==(const CellBox&) const = default;
};

/// The smallest rectangle around both.
inline CellBox united(const CellBox& a, const CellBox& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  const int x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.x + a.columns, b.x + b.columns) - x, std::max(a.y + a.rows, b.y + b.rows) - y};
}

/// How far from the origin a place may be to have a cell: with cells of a millimetre it still has a number.
inline constexpr double farthest_place = 1e6;  // m

/// True if cell_of() can tell the cell: finite, and not beyond farthest_place.
inline bool has_cell(const geometry::Vector2& point) {
  return std::abs(point.x()) <= farthest_place && std::abs(point.y()) <= farthest_place;  // false for NaN
}

/// The cell that a point of the map lies in; `resolution` is the side of a cell, m. The point must have a cell.
inline Cell cell_of(const geometry::Vector2& point, double resolution) {
  // As std::floor(), which is a call of a library.
  const auto below = [](double value) {
    const int whole = static_cast<int>(value);
    return whole - (value < whole ? 1 : 0);
  };
  return {below(point.x() / resolution), below(point.y() / resolution)};
}

inline geometry::Vector2 center_of(const Cell& cell, double resolution) {
  return {(cell.x + 0.5) * resolution, (cell.y + 0.5) * resolution};
}

/// Tiles are squares of cells that travel together. Tile (0, 0) begins with cell (0, 0).
inline constexpr int tile_side = 64;

/// Rounds towards minus infinity, unlike the language.
constexpr int tile_of(int cell) { return cell >= 0 ? cell / tile_side : -((-cell - 1) / tile_side) - 1; }

inline CellBox cells_of_tile(const Cell& tile) {
  return {tile.x * tile_side, tile.y * tile_side, tile_side, tile_side};
}

}  // namespace kervan::grid
