/// Adds one weight to a run of neighbouring cells.
#pragma once

#include <cstddef>

#include "components/grid/log_odds.hpp"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace kervan::mapping {

/// Each of `count` cells from `cells` on becomes added(cell, weight).
inline void add_run(grid::LogOdds* cells, std::ptrdiff_t count, grid::LogOdds weight) {
  std::ptrdiff_t i = 0;
#ifdef __SSE2__
  const __m128i weights = _mm_set1_epi16(weight);
  for (; i + 8 <= count; i += 8) {
    auto* const eight = reinterpret_cast<__m128i*>(cells + i);
    _mm_storeu_si128(eight, _mm_adds_epi16(_mm_loadu_si128(eight), weights));
  }
#endif
  for (; i < count; ++i) cells[i] = grid::added(cells[i], weight);
}

}  // namespace kervan::mapping
