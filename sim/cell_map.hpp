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

  /// What rays meet, in m and infinity for nothing within `range`; `faces` tell which edges (Face). The rays of all
  /// fans one after the other, and as many results. They do not depend on the instructions, which must be available.
  void cast(std::span<const RayFan> fans, double range, std::span<float> distances, std::span<std::int32_t> faces,
            Instructions instructions = widest()) const;

  /// The normal where a ray in `direction` met the face, on the ray's side.
  Vector2 normal(const Vector2& direction, std::int32_t face) const {
    if (face == within_cell) return -direction;
    const Vector2& axis = face == across_x ? along_ : upward_;
    return direction.dot(axis) > 0.0 ? Vector2(-axis) : axis;
  }

  /// True if the point lies in a solid cell.
  bool solid_at(const Vector2& point) const;

  /// No more than the distance from the point to the nearest solid cell; quick. Cells beyond the raster's border count
  /// as solid.
  double free_around(const Vector2& point) const;

  /// The borders of the solid cells.
  const ShapeMap& edges() const { return edges_; }

  const SkipTables& cells() const { return cells_; }

 private:
  Vector2 in_cells(const Vector2& point) const {  // from the lower left corner
    const Vector2 offset = point - corner_;
    return {along_.dot(offset) / cell_.x(), upward_.dot(offset) / cell_.y()};
  }
  /// Where a point is in the raster: its cell, and its place there, 0 .. 1.
  struct Place {
    std::int32_t column, row;
    float x, y;
  };
  Place place(const Vector2& in_cells) const;
  void cast_from_outside(const Vector2& origin_in_cells, const Vector2& direction, double range, float& distance,
                         std::int32_t& face) const;
  RayBatch batch(double range) const;  // without rays

  Vector2 corner_;          // lower left
  Vector2 along_, upward_;  // unit vectors of columns and rows
  Vector2 cell_;
  SkipTables cells_;
  ShapeMap edges_;
};

}  // namespace kervan::sim
