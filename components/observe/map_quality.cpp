#include "components/observe/map_quality.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kervan::observe {
namespace {

using grid::Cell;

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(part) / static_cast<double>(whole);
}

double entropy_of(std::int8_t percent) {
  const double p = 0.01 * percent;
  return p <= 0.0 || p >= 1.0 ? 0.0 : -p * std::log2(p) - (1.0 - p) * std::log2(1.0 - p);
}

/// True if `cell` or one beside it is so in truth.
template <class Is>
bool near_one(const Cell& cell, Is is) {
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (is(Cell{cell.x + dx, cell.y + dy})) return true;
  return false;
}

}  // namespace

MapQuality judge(const grid::Occupancy& map, const MapTruth& truth) {
  std::uint64_t judged = 0, right = 0, nearly_right = 0, known = 0;
  std::uint64_t known_free = 0, false_occupied = 0, known_solid = 0, false_free = 0, occupied = 0;
  double entropy = 0.0, error = 0.0, worst = 0.0;
  const auto& box = map.box();
  const auto on_surface = [&](const Cell& cell) {
    return truth.at(cell) == TrueCell::occupied || truth.at(cell) == TrueCell::border;
  };
  const auto said_occupied = [&](const Cell& cell) { return map.at(cell) > 50; };
  for (int y = box.y; y < box.y + box.rows; ++y)
    for (int x = box.x; x < box.x + box.columns; ++x) {
      const Cell cell{x, y};
      const std::int8_t percent = map.at(cell);
      if (percent < 0) continue;
      ++known;
      entropy += entropy_of(percent);
      const TrueCell is = truth.at(cell);
      const bool said = percent > 50;
      if (said) {
        const double off = truth.distance(grid::center_of(cell, map.resolution()));
        if (std::isfinite(off)) {
          ++occupied;
          error += off;
          worst = std::max(worst, off);
        }
      }
      if (is == TrueCell::hidden && said) continue;  // the inside of a wall: nobody can know how thick it is
      ++judged;
      const bool correct =
          is == TrueCell::free       ? !said
          : is == TrueCell::occupied ? said
          : is == TrueCell::border
              ? said || near_one(cell, [&](const Cell& c) { return on_surface(c) && said_occupied(c); })
              : false;
      if (correct) ++right;
      if (correct || (said ? near_one(cell, on_surface) : on_surface(cell) && near_one(cell, said_occupied)))
        ++nearly_right;
      if (is == TrueCell::free) {
        ++known_free;
        if (said) ++false_occupied;
      } else {
        ++known_solid;
        if (!correct) ++false_free;
      }
    }
  const auto& values = truth.cells().values();
  const auto all_free = static_cast<std::uint64_t>(std::count(values.begin(), values.end(), TrueCell::free));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {.judged = judged,
          .accuracy = share(right, judged),
          .near_accuracy = share(nearly_right, judged),
          .false_occupied = share(false_occupied, known_free),
          .false_free = share(false_free, known_solid),
          .coverage = share(known_free, all_free),
          .entropy_bits = known == 0 ? nan : entropy / static_cast<double>(known),
          .wall_error_m = occupied == 0 ? nan : error / static_cast<double>(occupied),
          .worst_wall_error_m = occupied == 0 ? nan : worst};
}

}  // namespace kervan::observe
