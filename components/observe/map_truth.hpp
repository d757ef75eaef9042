/// What a map of a world should look like.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "components/grid/grid.hpp"
#include "components/observe/map_drawing.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::observe {

/// What a cell is in truth.
enum class TrueCell : std::uint8_t {
  hidden,    ///< nobody can see it: within a solid obstacle, or outside of the room
  free,      ///< can be reached from one of the seeds without crossing a surface
  border,    ///< a surface runs along its border, within a tenth of a cell: it may be the wall's cell or the one before
  occupied,  ///< a surface passes through it
};

/// The world as cells.
class MapTruth {
 public:
  /// `seeds`: places where robots have stood, m. Their surroundings are looked at as far as the world's obstacles
  /// reach.
  MapTruth(const DrawnWorld& world, std::span<const geometry::Vector2> seeds, double resolution);

  TrueCell at(const grid::Cell& cell) const { return cells_.at(cell); }
  const grid::Grid<TrueCell>& cells() const { return cells_; }

  /// Distance from a point to the nearest surface, m; infinity in an empty world.
  double distance(const geometry::Vector2& point) const;

 private:
  struct Edge {
    geometry::Vector2 a, b;
  };

  void mark(const Edge& edge);
  void flood(std::span<const geometry::Vector2> seeds);

  std::vector<Edge> edges_;
  std::vector<DrawnCircle> circles_;
  grid::Grid<TrueCell> cells_;
};

}  // namespace kervan::observe
