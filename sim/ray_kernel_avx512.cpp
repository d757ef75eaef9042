// Compiled with -mavx512f: nothing but intrinsics and ray_kernel.hpp may be included (see there).
#include <immintrin.h>

#include "sim/ray_kernel.hpp"

namespace kervan::sim::kernel {

// Sixteen rays at a time; every step is that of cast_scalar.
void cast_avx512(const RayBatch& rays) {
  const std::int32_t stride = rays.columns + 1, plane = stride * (rays.rows + 1);
  const __m512 zero = _mm512_setzero_ps(), one = _mm512_set1_ps(1.0f), tiny = _mm512_set1_ps(1e-9f);
  const __m512 range = _mm512_set1_ps(rays.range);
  const __m512i none = _mm512_setzero_si512(), unit = _mm512_set1_epi32(1), byte = _mm512_set1_epi32(255);
  const __m512i row_stride = _mm512_set1_epi32(stride);
  for (std::int32_t i = 0; i < rays.count; i += 16) {
    const __mmask16 lanes = rays.count - i >= 16 ? __mmask16(0xffff) : __mmask16((1u << (rays.count - i)) - 1u);
    const __m512 dx = _mm512_maskz_loadu_ps(lanes, rays.dx + i), dy = _mm512_maskz_loadu_ps(lanes, rays.dy + i);
    __m512 c = _mm512_add_ps(_mm512_mul_ps(_mm512_set1_ps(rays.xx), dx), _mm512_mul_ps(_mm512_set1_ps(rays.xy), dy));
    __m512 s = _mm512_add_ps(_mm512_mul_ps(_mm512_set1_ps(rays.yx), dx), _mm512_mul_ps(_mm512_set1_ps(rays.yy), dy));
    const __mmask16 left = _mm512_cmp_ps_mask(c, zero, _CMP_LT_OQ), down = _mm512_cmp_ps_mask(s, zero, _CMP_LT_OQ);
    c = _mm512_max_ps(_mm512_abs_ps(c), tiny);
    s = _mm512_max_ps(_mm512_abs_ps(s), tiny);
    const __m512 per_c = _mm512_div_ps(one, c), per_s = _mm512_div_ps(one, s);
    __m512 ox = _mm512_maskz_loadu_ps(lanes, rays.x + i), oy = _mm512_maskz_loadu_ps(lanes, rays.y + i);
    __m512i column = _mm512_maskz_loadu_epi32(lanes, rays.column + i),
            row = _mm512_maskz_loadu_epi32(lanes, rays.row + i);
    ox = _mm512_mask_sub_ps(ox, left, one, ox);
    oy = _mm512_mask_sub_ps(oy, down, one, oy);
    column = _mm512_mask_sub_epi32(column, left, _mm512_set1_epi32(rays.columns - 1), column);
    row = _mm512_mask_sub_epi32(row, down, _mm512_set1_epi32(rays.rows - 1), row);
    const __m512i first = _mm512_add_epi32(
        _mm512_add_epi32(_mm512_maskz_set1_epi32(left, plane), _mm512_maskz_set1_epi32(down, 2 * plane)),
        _mm512_add_epi32(_mm512_mullo_epi32(row, row_stride), column));

    __m512i x = none, y = none;
    __m512 t = zero;
    __mmask16 crossed_x = 0, moved = 0, active = lanes;
    for (;;) {
      const __m512i at = _mm512_add_epi32(first, _mm512_add_epi32(_mm512_mullo_epi32(y, row_stride), x));
      const __m512i skip = _mm512_and_si512(_mm512_mask_i32gather_epi32(none, active, at, rays.skips, 1), byte);
      active = _mm512_mask_test_epi32_mask(active, skip, skip);
      if (active == 0) break;
      moved |= active;
      const __m512i end_x = _mm512_add_epi32(x, skip), end_y = _mm512_add_epi32(y, skip);
      const __m512 t_x = _mm512_mul_ps(_mm512_sub_ps(_mm512_cvtepi32_ps(end_x), ox), per_c);
      const __m512 t_y = _mm512_mul_ps(_mm512_sub_ps(_mm512_cvtepi32_ps(end_y), oy), per_s);
      const __mmask16 x_first = _mm512_cmp_ps_mask(t_x, t_y, _CMP_LT_OQ);
      const __m512 t_exit = _mm512_min_ps(t_x, t_y);
      const __m512i new_x =
          _mm512_max_epi32(x, _mm512_min_epi32(_mm512_cvttps_epi32(_mm512_add_ps(ox, _mm512_mul_ps(t_exit, c))),
                                               _mm512_sub_epi32(end_x, unit)));
      const __m512i new_y =
          _mm512_max_epi32(y, _mm512_min_epi32(_mm512_cvttps_epi32(_mm512_add_ps(oy, _mm512_mul_ps(t_exit, s))),
                                               _mm512_sub_epi32(end_y, unit)));
      t = _mm512_mask_mov_ps(t, active, t_exit);
      x = _mm512_mask_mov_epi32(x, active, _mm512_mask_blend_epi32(x_first, new_x, end_x));
      y = _mm512_mask_mov_epi32(y, active, _mm512_mask_blend_epi32(x_first, end_y, new_y));
      crossed_x = static_cast<__mmask16>((crossed_x & ~active) | (x_first & active));
      active = _mm512_mask_cmp_ps_mask(active, t_exit, range, _CMP_LE_OQ);
    }
    const __mmask16 hit = _mm512_cmp_ps_mask(t, range, _CMP_LE_OQ) &
                          _mm512_cmplt_epi32_mask(x, _mm512_sub_epi32(_mm512_set1_epi32(rays.columns), column)) &
                          _mm512_cmplt_epi32_mask(y, _mm512_sub_epi32(_mm512_set1_epi32(rays.rows), row));
    const __m512 distance = _mm512_mask_blend_ps(hit, _mm512_set1_ps(__builtin_inff()), t);
    const __m512i face = _mm512_maskz_mov_epi32(
        moved, _mm512_mask_blend_epi32(crossed_x, _mm512_set1_epi32(across_y), _mm512_set1_epi32(across_x)));
    _mm512_mask_storeu_ps(rays.distance + i, lanes, distance);
    _mm512_mask_storeu_epi32(rays.face + i, lanes, face);
  }
}

void find_near_avx512(const RayPaths& rays, float x, float y, float radius, std::uint16_t* near) {
  const __m512 center_x = _mm512_set1_ps(x), center_y = _mm512_set1_ps(y), reach = _mm512_set1_ps(radius);
  const __m512 behind = _mm512_set1_ps(-radius);
  for (std::int32_t i = 0; i < rays.count; i += 16) {
    const __m512 to_x = _mm512_sub_ps(center_x, _mm512_loadu_ps(rays.x + i));
    const __m512 to_y = _mm512_sub_ps(center_y, _mm512_loadu_ps(rays.y + i));
    const __m512 dx = _mm512_loadu_ps(rays.dx + i), dy = _mm512_loadu_ps(rays.dy + i);
    const __m512 along = _mm512_add_ps(_mm512_mul_ps(to_x, dx), _mm512_mul_ps(to_y, dy));
    const __m512 across = _mm512_sub_ps(_mm512_mul_ps(to_x, dy), _mm512_mul_ps(to_y, dx));
    __mmask16 found = _mm512_cmp_ps_mask(_mm512_abs_ps(across), reach, _CMP_LE_OQ);
    found = _mm512_mask_cmp_ps_mask(found, along, behind, _CMP_GE_OQ);
    *near++ = _mm512_mask_cmp_ps_mask(found, _mm512_sub_ps(along, reach), _mm512_loadu_ps(rays.length + i), _CMP_LE_OQ);
  }
}

}  // namespace kervan::sim::kernel
