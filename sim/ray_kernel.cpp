#include "sim/ray_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kervan::sim {

namespace kernel {

void cast_scalar(const RayBatch& rays) {
  constexpr float tiny = 1e-9f;  // in place of 0, which has no inverse
  const std::int32_t stride = rays.columns + 1, plane = stride * (rays.rows + 1);
  for (std::int32_t i = 0; i < rays.count; ++i) {
    float c = rays.xx * rays.dx[i] + rays.xy * rays.dy[i];
    float s = rays.yx * rays.dx[i] + rays.yy * rays.dy[i];
    const bool left = c < 0.0f, down = s < 0.0f;
    c = std::max(std::abs(c), tiny);
    s = std::max(std::abs(s), tiny);
    const float per_c = 1.0f / c, per_s = 1.0f / s;
    // Mirrored, and counted from the first cell, so that precision depends on the distance alone.
    const float ox = left ? 1.0f - rays.x[i] : rays.x[i];
    const float oy = down ? 1.0f - rays.y[i] : rays.y[i];
    const std::int32_t column = left ? rays.columns - 1 - rays.column[i] : rays.column[i];
    const std::int32_t row = down ? rays.rows - 1 - rays.row[i] : rays.row[i];
    const std::uint8_t* const skips = rays.skips + (left ? plane : 0) + (down ? 2 * plane : 0) + row * stride + column;

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
      if (t > rays.range) break;
    }
    const bool hit = !(t > rays.range) && x < rays.columns - column && y < rays.rows - row;
    rays.distance[i] = hit ? t : std::numeric_limits<float>::infinity();
    rays.face[i] = face;
  }
}

void find_near_scalar(const RayPaths& rays, float x, float y, float radius, std::uint16_t* near) {
  for (std::int32_t first = 0; first < rays.count; first += 16) {
    unsigned found = 0;
    for (std::int32_t k = 0; k < 16; ++k) {
      const std::int32_t i = first + k;
      const float to_x = x - rays.x[i], to_y = y - rays.y[i];
      const float along = to_x * rays.dx[i] + to_y * rays.dy[i], across = to_x * rays.dy[i] - to_y * rays.dx[i];
      const bool is_near = std::abs(across) <= radius && along >= -radius && along - radius <= rays.length[i];
      found |= static_cast<unsigned>(is_near) << k;
    }
    *near++ = static_cast<std::uint16_t>(found);
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

void cast(const RayBatch& rays, Instructions instructions) {
  switch (instructions) {
#ifdef KERVAN_WIDE_KERNELS
    case Instructions::avx512: return kernel::cast_avx512(rays);
    case Instructions::avx2: return kernel::cast_avx2(rays);
#endif
    default: return kernel::cast_scalar(rays);
  }
}

void find_near(const RayPaths& rays, float x, float y, float radius, std::uint16_t* near, Instructions instructions) {
  switch (instructions) {
#ifdef KERVAN_WIDE_KERNELS
    case Instructions::avx512: return kernel::find_near_avx512(rays, x, y, radius, near);
    case Instructions::avx2: return kernel::find_near_avx2(rays, x, y, radius, near);
#endif
    default: return kernel::find_near_scalar(rays, x, y, radius, near);
  }
}

}  // namespace kervan::sim
