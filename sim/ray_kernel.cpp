#include "sim/ray_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kervan::sim {

namespace kernel {

void cast_scalar(const RayFan& fan) {
  constexpr float tiny = 1e-9f;  // in place of 0, which has no inverse
  const std::int32_t stride = fan.columns + 1, plane = stride * (fan.rows + 1);
  for (std::int32_t i = 0; i < fan.count; ++i) {
    float c = fan.xx * fan.dx[i] + fan.xy * fan.dy[i];
    float s = fan.yx * fan.dx[i] + fan.yy * fan.dy[i];
    const bool left = c < 0.0f, down = s < 0.0f;
    c = std::max(std::abs(c), tiny);
    s = std::max(std::abs(s), tiny);
    const float per_c = 1.0f / c, per_s = 1.0f / s;
    // Mirrored, and counted from the first cell, so that precision depends on the distance alone.
    const float ox = left ? 1.0f - fan.x : fan.x;
    const float oy = down ? 1.0f - fan.y : fan.y;
    const std::int32_t column = left ? fan.columns - 1 - fan.column : fan.column;
    const std::int32_t row = down ? fan.rows - 1 - fan.row : fan.row;
    const std::uint8_t* const skips = fan.skips + (left ? plane : 0) + (down ? 2 * plane : 0) + row * stride + column;

    std::int32_t x = 0, y = 0;
    float t = 0.0f;
    Face face = within_cell;
    while (const std::int32_t skip = skips[y * stride + x]) {
      const std::int32_t end_x = x + skip, end_y = y + skip;
      const float t_x = (static_cast<float>(end_x) - ox) * per_c;
      const float t_y = (static_cast<float>(end_y) - oy) * per_s;
      // The other coordinate must neither go back nor leave the square, whatever rounding does: the ray would loop.
      if (t_x < t_y) {
        t = t_x;
        x = end_x;
        y = std::max(y, std::min(static_cast<std::int32_t>(oy + t * s), end_y - 1));
        face = across_x;
      } else {
        t = t_y;
        y = end_y;
        x = std::max(x, std::min(static_cast<std::int32_t>(ox + t * c), end_x - 1));
        face = across_y;
      }
      if (t > fan.range) break;
    }
    const bool hit = !(t > fan.range) && x < fan.columns - column && y < fan.rows - row;
    fan.distance[i] = hit ? t : std::numeric_limits<float>::infinity();
    fan.face[i] = face;
  }
}

}  // namespace kernel

bool available(Instructions instructions) {
#ifdef KERVAN_WIDE_KERNELS
  if (instructions == Instructions::avx512) return __builtin_cpu_supports("avx512f") != 0;
  if (instructions == Instructions::avx2) return __builtin_cpu_supports("avx2") != 0;
#endif
  return instructions == Instructions::scalar;
}

Instructions widest() {
  static const Instructions found = available(Instructions::avx512) ? Instructions::avx512
                                    : available(Instructions::avx2) ? Instructions::avx2
                                                                    : Instructions::scalar;
  return found;
}

void cast(const RayFan& fan, Instructions instructions) {
  switch (instructions) {
#ifdef KERVAN_WIDE_KERNELS
    case Instructions::avx512: return kernel::cast_avx512(fan);
    case Instructions::avx2: return kernel::cast_avx2(fan);
#endif
    default: return kernel::cast_scalar(fan);
  }
}

}  // namespace kervan::sim
