/// The cells that a straight line touches.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "framework/geometry/pose2.hpp"

namespace kervan::planning {

/// Calls `visit(x, y, share)` for each cell that the line from a to b goes through, in order, until it returns false.
/// Coordinates are in cells, cell (x, y) is the square from there to (x + 1, y + 1); `share` is the part of the line
/// that is in the cell, of 1. Where the line goes through a corner, the two cells beside it are touched, too, with a
/// share of 0. True if nobody said no. J. Amanatides and A. Woo 1987, "A Fast Voxel Traversal Algorithm for Ray
/// Tracing", doi:10.2312/egtp.19871000.
template <class Visit>
bool walk_line(const geometry::Vector2& a, const geometry::Vector2& b, const Visit& visit) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double corner = 1e-9;  // of the line: nearer than this to a corner is through it
  const geometry::Vector2 along = b - a;
  int x = static_cast<int>(std::floor(a.x())), y = static_cast<int>(std::floor(a.y()));
  const int right = along.x() > 0.0 ? 1 : -1, up = along.y() > 0.0 ? 1 : -1;
  const double per_column = along.x() != 0.0 ? 1.0 / std::abs(along.x()) : infinity;
  const double per_row = along.y() != 0.0 ? 1.0 / std::abs(along.y()) : infinity;
  // Where the line leaves the column and the row that it is in, as parts of it.
  double leaves_column = along.x() != 0.0 ? (right > 0 ? x + 1 - a.x() : a.x() - x) * per_column : infinity;
  double leaves_row = along.y() != 0.0 ? (up > 0 ? y + 1 - a.y() : a.y() - y) * per_row : infinity;
  double at = 0.0;
  for (;;) {
    const double next = std::min(leaves_column, leaves_row);
    if (!visit(x, y, std::min(next, 1.0) - at)) return false;
    if (next >= 1.0 - corner) return true;
    at = next;
    const bool through_corner = std::abs(leaves_column - leaves_row) <= corner;
    if (through_corner && !(visit(x + right, y, 0.0) && visit(x, y + up, 0.0))) return false;
    const bool sideways = through_corner || leaves_column < leaves_row;
    const bool upwards = through_corner || !sideways;
    if (sideways) {
      x += right;
      leaves_column += per_column;
    }
    if (upwards) {
      y += up;
      leaves_row += per_row;
    }
  }
}

}  // namespace kervan::planning
