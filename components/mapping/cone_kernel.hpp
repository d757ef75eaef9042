/// Adds what a reading says to the cells of a cone: the innermost loop of sonar maps.
#pragma once

#include <cstddef>
#include <cstdint>

#include "components/grid/log_odds.hpp"
#include "components/grid/masses.hpp"
#include "components/mapping/cone_stencil.hpp"

namespace kervan::mapping {

/// Distances in mm: cells nearer than `empty_below` are in Region II, those from there up to `occupied_to` in Region I.
struct ConeReading {
  std::int16_t empty_below;
  std::int16_t occupied_to;
};

/// Bayes' rule (equation 15) as an addition of logarithms. `tip`: the transducer's cell in a grid whose rows are
/// `stride` apart (negative: the cone is mirrored). The first `count` eights of the cone must lie in the grid.
void add_cone(grid::LogOdds* tip, std::ptrdiff_t stride, const Cone<std::int16_t>& cone, std::size_t count,
              ConeReading reading);

/// Dempster's rule for the same cells. Masses are held at 1 - least_unknown together.
void add_cone(grid::MassCell* tip, std::ptrdiff_t stride, const Cone<float>& cone, std::size_t count,
              ConeReading reading);

/// The same, cell by cell, with equal results to the bit: what add_cone() is on processors without SSE2.
void add_cone_portably(grid::LogOdds* tip, std::ptrdiff_t stride, const Cone<std::int16_t>& cone, std::size_t count,
                       ConeReading reading);
void add_cone_portably(grid::MassCell* tip, std::ptrdiff_t stride, const Cone<float>& cone, std::size_t count,
                       ConeReading reading);

}  // namespace kervan::mapping
