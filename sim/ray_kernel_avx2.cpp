// Compiled with -mavx2: nothing but intrinsics and ray_kernel.hpp may be included (see there).
#include <immintrin.h>

#include "sim/ray_kernel.hpp"

namespace kervan::sim::kernel {

// Eight rays at a time; every step is that of cast_scalar. Masks are lanes of all ones or zeros.
void cast_avx2(const RayBatch& rays) {
  const std::int32_t stride = rays.columns + 1, plane = stride * (rays.rows + 1);
  const __m256 zero = _mm256_setzero_ps(), one = _mm256_set1_ps(1.0f), tiny = _mm256_set1_ps(1e-9f);
  const __m256 range = _mm256_set1_ps(rays.range), sign = _mm256_set1_ps(-0.0f);
  const __m256i none = _mm256_setzero_si256(), unit = _mm256_set1_epi32(1), byte = _mm256_set1_epi32(255);
  const __m256i row_stride = _mm256_set1_epi32(stride), order = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const int* const skips = reinterpret_cast<const int*>(rays.skips);
  for (std::int32_t i = 0; i < rays.count; i += 8) {
    const __m256i lanes = _mm256_cmpgt_epi32(_mm256_set1_epi32(rays.count - i), order);
    const __m256 dx = _mm256_maskload_ps(rays.dx + i, lanes), dy = _mm256_maskload_ps(rays.dy + i, lanes);
    __m256 c = _mm256_add_ps(_mm256_mul_ps(_mm256_set1_ps(rays.xx), dx), _mm256_mul_ps(_mm256_set1_ps(rays.xy), dy));
    __m256 s = _mm256_add_ps(_mm256_mul_ps(_mm256_set1_ps(rays.yx), dx), _mm256_mul_ps(_mm256_set1_ps(rays.yy), dy));
    const __m256 left = _mm256_cmp_ps(c, zero, _CMP_LT_OQ), down = _mm256_cmp_ps(s, zero, _CMP_LT_OQ);
    c = _mm256_max_ps(_mm256_andnot_ps(sign, c), tiny);
    s = _mm256_max_ps(_mm256_andnot_ps(sign, s), tiny);
    const __m256 per_c = _mm256_div_ps(one, c), per_s = _mm256_div_ps(one, s);
    const __m256i leftwards = _mm256_castps_si256(left), downwards = _mm256_castps_si256(down);
    __m256 ox = _mm256_maskload_ps(rays.x + i, lanes), oy = _mm256_maskload_ps(rays.y + i, lanes);
    __m256i column = _mm256_maskload_epi32(rays.column + i, lanes), row = _mm256_maskload_epi32(rays.row + i, lanes);
    ox = _mm256_blendv_ps(ox, _mm256_sub_ps(one, ox), left);
    oy = _mm256_blendv_ps(oy, _mm256_sub_ps(one, oy), down);
    column = _mm256_blendv_epi8(column, _mm256_sub_epi32(_mm256_set1_epi32(rays.columns - 1), column), leftwards);
    row = _mm256_blendv_epi8(row, _mm256_sub_epi32(_mm256_set1_epi32(rays.rows - 1), row), downwards);
    const __m256i first = _mm256_add_epi32(_mm256_add_epi32(_mm256_and_si256(leftwards, _mm256_set1_epi32(plane)),
                                                            _mm256_and_si256(downwards, _mm256_set1_epi32(2 * plane))),
                                           _mm256_add_epi32(_mm256_mullo_epi32(row, row_stride), column));

    __m256i x = none, y = none, crossed_x = none, moved = none, active = lanes;
    __m256 t = zero;
    for (;;) {
      const __m256i at = _mm256_add_epi32(first, _mm256_add_epi32(_mm256_mullo_epi32(y, row_stride), x));
      const __m256i skip = _mm256_and_si256(_mm256_mask_i32gather_epi32(none, skips, at, active, 1), byte);
      active = _mm256_cmpgt_epi32(skip, none);
      if (_mm256_testz_si256(active, active)) break;
      moved = _mm256_or_si256(moved, active);
      const __m256i end_x = _mm256_add_epi32(x, skip), end_y = _mm256_add_epi32(y, skip);
      const __m256 t_x = _mm256_mul_ps(_mm256_sub_ps(_mm256_cvtepi32_ps(end_x), ox), per_c);
      const __m256 t_y = _mm256_mul_ps(_mm256_sub_ps(_mm256_cvtepi32_ps(end_y), oy), per_s);
      const __m256i x_first = _mm256_castps_si256(_mm256_cmp_ps(t_x, t_y, _CMP_LT_OQ));
      const __m256 t_exit = _mm256_min_ps(t_x, t_y);
      const __m256i new_x =
          _mm256_max_epi32(x, _mm256_min_epi32(_mm256_cvttps_epi32(_mm256_add_ps(ox, _mm256_mul_ps(t_exit, c))),
                                               _mm256_sub_epi32(end_x, unit)));
      const __m256i new_y =
          _mm256_max_epi32(y, _mm256_min_epi32(_mm256_cvttps_epi32(_mm256_add_ps(oy, _mm256_mul_ps(t_exit, s))),
                                               _mm256_sub_epi32(end_y, unit)));
      t = _mm256_blendv_ps(t, t_exit, _mm256_castsi256_ps(active));
      x = _mm256_blendv_epi8(x, _mm256_blendv_epi8(new_x, end_x, x_first), active);
      y = _mm256_blendv_epi8(y, _mm256_blendv_epi8(end_y, new_y, x_first), active);
      crossed_x = _mm256_blendv_epi8(crossed_x, x_first, active);
      active = _mm256_and_si256(active, _mm256_castps_si256(_mm256_cmp_ps(t_exit, range, _CMP_LE_OQ)));
    }
    const __m256i within =
        _mm256_and_si256(_mm256_cmpgt_epi32(_mm256_sub_epi32(_mm256_set1_epi32(rays.columns), column), x),
                         _mm256_cmpgt_epi32(_mm256_sub_epi32(_mm256_set1_epi32(rays.rows), row), y));
    const __m256 hit = _mm256_and_ps(_mm256_cmp_ps(t, range, _CMP_LE_OQ), _mm256_castsi256_ps(within));
    const __m256 distance = _mm256_blendv_ps(_mm256_set1_ps(__builtin_inff()), t, hit);
    const __m256i face = _mm256_and_si256(
        moved, _mm256_blendv_epi8(_mm256_set1_epi32(across_y), _mm256_set1_epi32(across_x), crossed_x));
    _mm256_maskstore_ps(rays.distance + i, lanes, distance);
    _mm256_maskstore_epi32(rays.face + i, lanes, face);
  }
}

void find_near_avx2(const RayPaths& rays, float x, float y, float radius, std::uint16_t* near) {
  const __m256 center_x = _mm256_set1_ps(x), center_y = _mm256_set1_ps(y), reach = _mm256_set1_ps(radius);
  const __m256 behind = _mm256_set1_ps(-radius), sign = _mm256_set1_ps(-0.0f);
  const auto eight = [&](std::int32_t i) {
    const __m256 to_x = _mm256_sub_ps(center_x, _mm256_loadu_ps(rays.x + i));
    const __m256 to_y = _mm256_sub_ps(center_y, _mm256_loadu_ps(rays.y + i));
    const __m256 dx = _mm256_loadu_ps(rays.dx + i), dy = _mm256_loadu_ps(rays.dy + i);
    const __m256 along = _mm256_add_ps(_mm256_mul_ps(to_x, dx), _mm256_mul_ps(to_y, dy));
    const __m256 across = _mm256_sub_ps(_mm256_mul_ps(to_x, dy), _mm256_mul_ps(to_y, dx));
    const __m256 beside = _mm256_cmp_ps(_mm256_andnot_ps(sign, across), reach, _CMP_LE_OQ);
    const __m256 ahead = _mm256_cmp_ps(along, behind, _CMP_GE_OQ);
    const __m256 length = _mm256_loadu_ps(rays.length + i);
    const __m256 within = _mm256_cmp_ps(_mm256_sub_ps(along, reach), length, _CMP_LE_OQ);
    return _mm256_movemask_ps(_mm256_and_ps(_mm256_and_ps(beside, ahead), within));
  };
  for (std::int32_t i = 0; i < rays.count; i += 16) *near++ = static_cast<std::uint16_t>(eight(i) | eight(i + 8) << 8);
}

}  // namespace kervan::sim::kernel
