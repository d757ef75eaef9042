/// A bitmap that never moves, made ready for questions. Metres, in the frame `map`.
#pragma once

#include <cstdint>
#include <span>

#include "sim/bitmap.hpp"
#include "sim/ray_kernel.hpp"
#include "sim/shape_map.hpp"
#include "sim/skip_tables.hpp"

namespace kervan::sim {

/// Rays go through the cells (ray_kernel.hpp) in single precision: as if a ray were turned by up to some 1e-7 rad and
/// lengthened by a millionth, and a few in a million pass a cell's corner on the other side. Distances and clearances
/// are exact: those of the edges between solid and free cells.
class CellMap {
 public:
  /// `bitmap` must be valid (require_valid).
  explicit CellMap(const Bitmap& bitmap);

  /// What rays from one point meet, in m and infinity for nothing within `range`; `faces` tell which edges (Face).
  /// Direction i is the unit vector (dx[i], dy[i]). All spans are equally long. The results do not depend on the
  /// instructions, which must be available.
  void cast(const Vector2& origin, std::span<const float> dx, std::span<const float> dy, double range,
            std::span<float> distances, std::span<std::int32_t> faces, Instructions instructions = widest()) const;

  /// The normal where a ray in `direction` met the face, on the ray's side.
  Vector2 normal(const Vector2& direction, std::int32_t face) const;

  /// True if the point lies in a solid cell.
  bool solid_at(const Vector2& point) const;

  /// The borders of the solid cells.
  const ShapeMap& edges() const { return edges_; }

  const SkipTables& cells() const { return cells_; }

 private:
  Vector2 in_cells(const Vector2& point) const;  // from the lower left corner
  RayFan fan(const Vector2& origin_in_cells, double range) const;
  void cast_from_outside(const Vector2& origin_in_cells, RayFan fan, double range, Instructions instructions) const;

  Vector2 corner_;          // lower left
  Vector2 along_, upward_;  // unit vectors of columns and rows
  Vector2 cell_;
  SkipTables cells_;
  ShapeMap edges_;
};

}  // namespace kervan::sim
