// Compiled with -mavx512f: nothing but intrinsics and ray_kernel.hpp may be included (see there).
#include <immintrin.h>

#include "sim/ray_kernel.hpp"

namespace kervan::sim::kernel {

namespace {

constexpr std::int32_t lanes = 16, most = most_rays;

/// Rays that are ready to go, mirrored so that all go to the right and up, and counted from their first cells.
struct Ready {
  // Some lanes more, since whole registers are read from any place.
  alignas(64) float c[most + lanes], s[most + lanes], per_c[most + lanes], per_s[most + lanes], ox[most + lanes],
      oy[most + lanes];
  alignas(64) std::int32_t first[most + lanes];                        // the cell, in the tables
  alignas(64) std::int32_t columns[most + lanes], rows[most + lanes];  // from there to the raster's end
};

void prepare(const RayBatch& rays, std::int32_t from, std::int32_t count, Ready& ready) {
  const std::int32_t stride = rays.columns + 1, plane = stride * (rays.rows + 1);
  const __m512 zero = _mm512_setzero_ps(), one = _mm512_set1_ps(1.0f), tiny = _mm512_set1_ps(1e-9f);
  for (std::int32_t k = 0; k < count; k += lanes) {
    const std::int32_t i = from + k;
    const __mmask16 valid = count - k >= lanes ? __mmask16(0xffff) : __mmask16((1u << (count - k)) - 1u);
    const __m512 dx = _mm512_maskz_loadu_ps(valid, rays.dx + i), dy = _mm512_maskz_loadu_ps(valid, rays.dy + i);
    __m512 c = _mm512_add_ps(_mm512_mul_ps(_mm512_set1_ps(rays.xx), dx), _mm512_mul_ps(_mm512_set1_ps(rays.xy), dy));
    __m512 s = _mm512_add_ps(_mm512_mul_ps(_mm512_set1_ps(rays.yx), dx), _mm512_mul_ps(_mm512_set1_ps(rays.yy), dy));
    const __mmask16 left = _mm512_cmp_ps_mask(c, zero, _CMP_LT_OQ), down = _mm512_cmp_ps_mask(s, zero, _CMP_LT_OQ);
    c = _mm512_max_ps(_mm512_abs_ps(c), tiny);
    s = _mm512_max_ps(_mm512_abs_ps(s), tiny);
    _mm512_store_ps(ready.c + k, c);
    _mm512_store_ps(ready.s + k, s);
    _mm512_store_ps(ready.per_c + k, _mm512_div_ps(one, c));
    _mm512_store_ps(ready.per_s + k, _mm512_div_ps(one, s));
    const __m512 ox = _mm512_maskz_loadu_ps(valid, rays.x + i), oy = _mm512_maskz_loadu_ps(valid, rays.y + i);
    _mm512_store_ps(ready.ox + k, _mm512_mask_sub_ps(ox, left, one, ox));
    _mm512_store_ps(ready.oy + k, _mm512_mask_sub_ps(oy, down, one, oy));
    __m512i column = _mm512_maskz_loadu_epi32(valid, rays.column + i),
            row = _mm512_maskz_loadu_epi32(valid, rays.row + i);
    column = _mm512_mask_sub_epi32(column, left, _mm512_set1_epi32(rays.columns - 1), column);
    row = _mm512_mask_sub_epi32(row, down, _mm512_set1_epi32(rays.rows - 1), row);
    _mm512_store_si512(ready.columns + k, _mm512_sub_epi32(_mm512_set1_epi32(rays.columns), column));
    _mm512_store_si512(ready.rows + k, _mm512_sub_epi32(_mm512_set1_epi32(rays.rows), row));
    const __m512i first = _mm512_add_epi32(
        _mm512_add_epi32(_mm512_maskz_set1_epi32(left, plane), _mm512_maskz_set1_epi32(down, 2 * plane)),
        _mm512_add_epi32(_mm512_mullo_epi32(row, _mm512_set1_epi32(stride)), column));
    _mm512_store_si512(ready.first + k, first);
  }
}

/// Sixteen rays on their way.
struct Way {
  __m512 c, s, per_c, per_s, ox, oy, t;
  __m512i first, x, y, ray;
  __mmask16 crossed_x, moved;
  __mmask16 active;  // lanes whose rays go on
  __mmask16 taken;   // lanes that hold a ray whose result is not stored yet
};

/// Stores the results of the rays that have arrived.
inline void store_arrived(const RayBatch& rays, std::int32_t from, const Ready& ready, Way& way) {
  const __mmask16 arrived = static_cast<__mmask16>(way.taken & ~way.active);
  way.taken = way.active;
  if (arrived == 0) return;
  const __m512i none = _mm512_setzero_si512();
  const __m512i columns = _mm512_mask_i32gather_epi32(none, arrived, way.ray, ready.columns, 4),
                rows = _mm512_mask_i32gather_epi32(none, arrived, way.ray, ready.rows, 4);
  const __mmask16 hit = _mm512_cmp_ps_mask(way.t, _mm512_set1_ps(rays.range), _CMP_LE_OQ) &
                        _mm512_cmplt_epi32_mask(way.x, columns) & _mm512_cmplt_epi32_mask(way.y, rows);
  const __m512 distance = _mm512_mask_blend_ps(hit, _mm512_set1_ps(__builtin_inff()), way.t);
  const __m512i face = _mm512_maskz_mov_epi32(
      way.moved, _mm512_mask_blend_epi32(way.crossed_x, _mm512_set1_epi32(across_y), _mm512_set1_epi32(across_x)));
  _mm512_mask_i32scatter_ps(rays.distance + from, arrived, way.ray, distance, 4);
  _mm512_mask_i32scatter_epi32(rays.face + from, arrived, way.ray, face, 4);
}

/// Sends rays off in the lanes that are free, from `next` on as far as there are any. Returns the next that waits.
inline std::int32_t send(const Ready& ready, std::int32_t next, std::int32_t count, Way& way) {
  const __m512i order = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  __mmask16 free = static_cast<__mmask16>(~way.active);
  const __m512i place = _mm512_maskz_expand_epi32(free, order);
  free = _mm512_mask_cmplt_epi32_mask(free, place, _mm512_set1_epi32(count - next));
  way.c = _mm512_mask_expand_ps(way.c, free, _mm512_loadu_ps(ready.c + next));
  way.s = _mm512_mask_expand_ps(way.s, free, _mm512_loadu_ps(ready.s + next));
  way.per_c = _mm512_mask_expand_ps(way.per_c, free, _mm512_loadu_ps(ready.per_c + next));
  way.per_s = _mm512_mask_expand_ps(way.per_s, free, _mm512_loadu_ps(ready.per_s + next));
  way.ox = _mm512_mask_expand_ps(way.ox, free, _mm512_loadu_ps(ready.ox + next));
  way.oy = _mm512_mask_expand_ps(way.oy, free, _mm512_loadu_ps(ready.oy + next));
  way.first = _mm512_mask_expand_epi32(way.first, free, _mm512_loadu_si512(ready.first + next));
  way.ray = _mm512_mask_add_epi32(way.ray, free, place, _mm512_set1_epi32(next));
  const __mmask16 kept = static_cast<__mmask16>(~free);
  way.x = _mm512_maskz_mov_epi32(kept, way.x);
  way.y = _mm512_maskz_mov_epi32(kept, way.y);
  way.t = _mm512_maskz_mov_ps(kept, way.t);
  way.crossed_x &= kept;
  way.moved &= kept;
  way.active |= free;
  way.taken |= free;
  return next + __builtin_popcount(free);
}

/// What the tables say of the cells in which the rays stand.
inline __m512i look_up(const RayBatch& rays, const Way& way) {
  const __m512i row = _mm512_mullo_epi32(way.y, _mm512_set1_epi32(rays.columns + 1));
  const __m512i at = _mm512_add_epi32(way.first, _mm512_add_epi32(row, way.x));
  const __m512i found = _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), way.active, at, rays.skips, 1);
  return _mm512_and_si512(found, _mm512_set1_epi32(255));
}

/// One jump of each ray; every step is that of cast_scalar.
inline void jump(float range, __m512i skip, Way& way) {
  const __m512i unit = _mm512_set1_epi32(1);
  way.active = _mm512_mask_test_epi32_mask(way.active, skip, skip);
  way.moved |= way.active;
  const __m512i end_x = _mm512_add_epi32(way.x, skip), end_y = _mm512_add_epi32(way.y, skip);
  const __m512 t_x = _mm512_mul_ps(_mm512_sub_ps(_mm512_cvtepi32_ps(end_x), way.ox), way.per_c);
  const __m512 t_y = _mm512_mul_ps(_mm512_sub_ps(_mm512_cvtepi32_ps(end_y), way.oy), way.per_s);
  const __mmask16 x_first = _mm512_cmp_ps_mask(t_x, t_y, _CMP_LT_OQ);
  const __m512 t_exit = _mm512_min_ps(t_x, t_y);
  const __m512i at_x = _mm512_cvttps_epi32(_mm512_add_ps(way.ox, _mm512_mul_ps(t_exit, way.c)));
  const __m512i at_y = _mm512_cvttps_epi32(_mm512_add_ps(way.oy, _mm512_mul_ps(t_exit, way.s)));
  const __m512i new_x = _mm512_max_epi32(way.x, _mm512_min_epi32(at_x, _mm512_sub_epi32(end_x, unit)));
  const __m512i new_y = _mm512_max_epi32(way.y, _mm512_min_epi32(at_y, _mm512_sub_epi32(end_y, unit)));
  way.t = _mm512_mask_mov_ps(way.t, way.active, t_exit);
  way.x = _mm512_mask_mov_epi32(way.x, way.active, _mm512_mask_blend_epi32(x_first, new_x, end_x));
  way.y = _mm512_mask_mov_epi32(way.y, way.active, _mm512_mask_blend_epi32(x_first, end_y, new_y));
  way.crossed_x = static_cast<__mmask16>((way.crossed_x & ~way.active) | (x_first & way.active));
  way.active = _mm512_mask_cmp_ps_mask(way.active, t_exit, _mm512_set1_ps(range), _CMP_LE_OQ);
}

}  // namespace

// A jump is a chain of operations, each of which waits for the one before, and for memory. Therefore two registers of
// rays are on their way at once; and when most rays of one have arrived, others take their lanes.
void cast_avx512(const RayBatch& rays) {
  constexpr int few = 4;
  Ready ready;
  for (std::int32_t from = 0; from < rays.count; from += most) {
    const std::int32_t count = rays.count - from < most ? rays.count - from : most;
    prepare(rays, from, count, ready);
    Way a{}, b{};
    std::int32_t next = send(ready, 0, count, a);
    next = send(ready, next, count, b);
    while ((a.active | b.active) != 0) {
      const __m512i skip_a = look_up(rays, a), skip_b = look_up(rays, b);
      jump(rays.range, skip_a, a);
      jump(rays.range, skip_b, b);
      if (next == count) continue;
      Way* const ways[] = {&a, &b};
      for (Way* way : ways)
        if (__builtin_popcount(way->active) <= few) {
          store_arrived(rays, from, ready, *way);
          next = send(ready, next, count, *way);
        }
    }
    store_arrived(rays, from, ready, a);
    store_arrived(rays, from, ready, b);
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
