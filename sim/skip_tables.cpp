#include "sim/skip_tables.hpp"

#include <algorithm>
#include <cassert>

namespace kervan::sim {

SkipTables::SkipTables(int columns, int rows, std::span<const std::uint8_t> blocked)
    : columns_(columns), rows_(rows), entries_(4 * plane() + 3, 0) {
  assert(blocked.size() == static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int quadrant = 0; quadrant < 4; ++quadrant) {
    std::uint8_t* const table = entries_.data() + static_cast<std::size_t>(quadrant) * plane();
    for (int y = rows - 1; y >= 0; --y) {
      const int row = (quadrant & 2) != 0 ? rows - 1 - y : y;
      const std::uint8_t* const source =
          blocked.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(columns);
      std::uint8_t* const here = table + static_cast<std::size_t>(y) * stride();
      const std::uint8_t* const above = here + stride();
      for (int x = columns - 1; x >= 0; --x) {
        if (source[(quadrant & 1) != 0 ? columns - 1 - x : x] != 0) continue;
        const int nearest = std::min({here[x + 1], above[x], above[x + 1]});
        here[x] = static_cast<std::uint8_t>(std::min(nearest, 254) + 1);
      }
    }
  }
}

int SkipTables::free_around(int column, int row) const {
  const int left = columns_ - 1 - column, below = rows_ - 1 - row;
  return std::min({entry(0, column, row), entry(1, left, row), entry(2, column, below), entry(3, left, below)});
}

}  // namespace kervan::sim
