/// A map of the places that echoes came from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "components/grid/grid.hpp"
#include "components/grid/log_odds.hpp"

namespace kervan::localization {

/// A cell knows how likely it is to be occupied, as log-odds (Moravec and Elfes 1985), and where in it the echoes came
/// from on average: a wall is known better than its cells are wide.
struct PointCell {
  grid::LogOdds log_odds = 0;
  std::uint16_t echoes = 0;  ///< at most most_echoes
  float x = 0.0f, y = 0.0f;  ///< their mean, from the middle of the cell, in cells

  /// Later echoes count as this many do together: what moved is followed.
  static constexpr std::uint16_t most_echoes = 50;
};

/// A piece of a wall, or of whatever is there.
struct Surface {
  geometry::Vector2 middle;  ///< m, in map
  geometry::Vector2 normal;  ///< of length 1, to either side
  double thickness = 0.0;    ///< m, standard deviation of the echoes along the normal
};

class PointMap {
 public:
  /// `resolution`: side of a cell, m. `most_bytes`: that the cells may take.
  PointMap(double resolution, std::size_t most_bytes) : cells_(resolution, {}, most_bytes) {}

  /// An echo from `point`, heard or seen from `sensor`, both in map: what lies between is free. False if the map may
  /// not grow that far; then it stays as it is.
  bool add(const geometry::Vector2& sensor, const geometry::Vector2& point);

  /// The surface nearest to a place, no farther than `reach` away, m: a line through what is occupied around it.
  /// Nothing if there is none, or what is there has no direction.
  std::optional<Surface> surface(const geometry::Vector2& at, double reach) const;

  double resolution() const { return cells_.resolution(); }
  grid::CellBox box() const { return cells_.box(); }
  const PointCell& at(const grid::Cell& cell) const { return box().contains(cell) ? *cells_.place(cell) : nothing_; }

 private:
  /// Where an occupied cell's echoes came from, in cells from the map's origin; nothing if it is not occupied.
  std::optional<geometry::Vector2> echo(const grid::Cell& cell) const;

  grid::Grid<PointCell> cells_;
  PointCell nothing_;
};

}  // namespace kervan::localization
