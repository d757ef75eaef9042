#include "tests/bench/ray_reference.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::bench {

float walk(const Raster& raster, float x, float y, float dx, float dy, float range) {
  int column = static_cast<int>(x), row = static_cast<int>(y);
  const auto solid = [&] {
    return raster.solid[static_cast<std::size_t>(row) * static_cast<std::size_t>(raster.columns) +
                        static_cast<std::size_t>(column)] != 0;
  };
  if (solid()) return 0.0f;
  const int step_x = dx > 0.0f ? 1 : -1, step_y = dy > 0.0f ? 1 : -1;
  const float stride_x = 1.0f / std::max(std::abs(dx), 1e-9f), stride_y = 1.0f / std::max(std::abs(dy), 1e-9f);
  const auto cells = [](int i) { return static_cast<float>(i); };
  float t_x = (dx > 0.0f ? cells(column + 1) - x : x - cells(column)) * stride_x;
  float t_y = (dy > 0.0f ? cells(row + 1) - y : y - cells(row)) * stride_y;
  for (;;) {
    float t;
    if (t_x < t_y) {
      t = t_x;
      t_x += stride_x;
      column += step_x;
    } else {
      t = t_y;
      t_y += stride_y;
      row += step_y;
    }
    if (t >= range) return range;
    if (solid()) return t;
  }
}

}  // namespace kervan::bench
