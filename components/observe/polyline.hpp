/// Driven paths as few points as a drawing needs.
#pragma once

#include <vector>

#include "framework/geometry/pose2.hpp"

namespace kervan::observe {

using Polyline = std::vector<geometry::Vector2>;

/// The points of `line` without which it would move by more than `tolerance` metres, first and last included.
///
/// D. H. Douglas, T. K. Peucker, "Algorithms for the Reduction of the Number of Points Required to Represent a
/// Digitized Line or its Caricature", Cartographica 10(2), 1973, doi:10.3138/FM57-6770-U75U-7727.
Polyline simplified(const Polyline& line, double tolerance);

}  // namespace kervan::observe
