#include "components/mapping/cone_kernel.hpp"

#include <algorithm>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace kervan::mapping {
namespace {

constexpr float inverse_of_most_known = 1.0f / (1.0f - grid::least_unknown);

/// Where the first cell of an eight is.
template <class CellValue, class Place>
CellValue* cells_at(CellValue* tip, std::ptrdiff_t stride, const Place& place) {
  return tip + place.y * stride + place.x;
}

/// Dempster's rule for one cell and a belief of one kind, one of the two weights being zero. What is known is scaled
/// down if it would leave less than least_unknown.
grid::MassCell combined(const grid::MassCell& cell, float empty, float occupied) {
  if (empty + occupied == 0.0f) return cell;
  const float unknown = (1.0f - cell.occupied) - cell.empty;
  const float more_occupied = (cell.occupied + unknown * occupied) - cell.occupied * empty;
  const float more_empty = (cell.empty + unknown * empty) - cell.empty * occupied;
  const float agreed = 1.0f - (cell.occupied * empty + cell.empty * occupied);
  const float divisor = std::max(agreed, (more_occupied + more_empty) * inverse_of_most_known);
  return {more_occupied / divisor, more_empty / divisor};
}

}  // namespace

void add_cone_portably(grid::LogOdds* tip, std::ptrdiff_t stride, const Cone<std::int16_t>& cone, std::size_t count,
                       ConeReading reading) {
  for (std::size_t i = 0; i < count; ++i) {
    grid::LogOdds* const cells = cells_at(tip, stride, cone.places[i]);
    for (std::size_t k = 0; k < 8; ++k) {
      const std::int16_t d = cone.distance[i].of[k];
      cells[k] = grid::added(cells[k], d < reading.empty_below    ? cone.empty[i].of[k]
                                       : d <= reading.occupied_to ? cone.occupied[i].of[k]
                                                                  : std::int16_t{0});
    }
  }
}

void add_cone_portably(grid::MassCell* tip, std::ptrdiff_t stride, const Cone<float>& cone, std::size_t count,
                       ConeReading reading) {
  for (std::size_t i = 0; i < count; ++i) {
    grid::MassCell* const cells = cells_at(tip, stride, cone.places[i]);
    for (std::size_t k = 0; k < 8; ++k) {
      const std::int16_t d = cone.distance[i].of[k];
      const bool empty = d < reading.empty_below;
      cells[k] = combined(cells[k], empty ? cone.empty[i].of[k] : 0.0f,
                          !empty && d <= reading.occupied_to ? cone.occupied[i].of[k] : 0.0f);
    }
  }
}

#ifdef __SSE2__

namespace {

template <class Value>
__m128i load(const Eight<Value>& eight) {
  return _mm_load_si128(reinterpret_cast<const __m128i*>(eight.of.data()));
}

}  // namespace

void add_cone(grid::LogOdds* tip, std::ptrdiff_t stride, const Cone<std::int16_t>& cone, std::size_t count,
              ConeReading reading) {
  // Copies of the pointers: a store of a vector may, for all the compiler knows, change a member.
  const auto* const places = cone.places.data();
  const auto* const empty = cone.empty.data();
  const auto cells_of = [=](std::size_t i) { return reinterpret_cast<__m128i*>(cells_at(tip, stride, places[i])); };
  const std::size_t all_empty = std::min(count, cone.wholly_before(reading.empty_below));
  for (std::size_t i = 0; i < all_empty; ++i) {
    __m128i* const cells = cells_of(i);
    _mm_storeu_si128(cells, _mm_adds_epi16(_mm_loadu_si128(cells), load(empty[i])));
  }
  const auto* const occupied = cone.occupied.data();
  const auto* const distances = cone.distance.data();
  const __m128i empty_below = _mm_set1_epi16(reading.empty_below);
  const __m128i beyond = _mm_set1_epi16(static_cast<std::int16_t>(reading.occupied_to + 1));
  for (std::size_t i = all_empty; i < count; ++i) {
    __m128i* const cells = cells_of(i);
    const __m128i distance = load(distances[i]);
    const __m128i is_empty = _mm_cmplt_epi16(distance, empty_below), is_near = _mm_cmplt_epi16(distance, beyond);
    const __m128i weight = _mm_or_si128(_mm_and_si128(is_empty, load(empty[i])),
                                        _mm_andnot_si128(is_empty, _mm_and_si128(is_near, load(occupied[i]))));
    _mm_storeu_si128(cells, _mm_adds_epi16(_mm_loadu_si128(cells), weight));
  }
}

namespace {

/// Four cells of an eight, as combined() does them one by one. `is_empty` and `is_near` are 32-bit masks.
void combine_four(float* cells, const float* empty_weights, const float* occupied_weights, __m128 is_empty,
                  __m128 is_near) {
  const __m128 one = _mm_set1_ps(1.0f);
  const __m128 first = _mm_loadu_ps(cells), second = _mm_loadu_ps(cells + 4);
  const __m128 occupied = _mm_shuffle_ps(first, second, _MM_SHUFFLE(2, 0, 2, 0));
  const __m128 empty = _mm_shuffle_ps(first, second, _MM_SHUFFLE(3, 1, 3, 1));
  const __m128 for_empty = _mm_and_ps(is_empty, _mm_load_ps(empty_weights));
  const __m128 for_occupied = _mm_andnot_ps(is_empty, _mm_and_ps(is_near, _mm_load_ps(occupied_weights)));

  const __m128 unknown = _mm_sub_ps(_mm_sub_ps(one, occupied), empty);
  const __m128 against_occupied = _mm_mul_ps(occupied, for_empty), against_empty = _mm_mul_ps(empty, for_occupied);
  const __m128 more_occupied = _mm_sub_ps(_mm_add_ps(occupied, _mm_mul_ps(unknown, for_occupied)), against_occupied);
  const __m128 more_empty = _mm_sub_ps(_mm_add_ps(empty, _mm_mul_ps(unknown, for_empty)), against_empty);
  const __m128 agreed = _mm_sub_ps(one, _mm_add_ps(against_occupied, against_empty));
  const __m128 divisor =
      _mm_max_ps(agreed, _mm_mul_ps(_mm_add_ps(more_occupied, more_empty), _mm_set1_ps(inverse_of_most_known)));
  // Cells that are told nothing keep their bits.
  const __m128 told = _mm_cmpneq_ps(_mm_add_ps(for_empty, for_occupied), _mm_setzero_ps());
  const auto chosen = [&told](__m128 fresh, __m128 old) {
    return _mm_or_ps(_mm_and_ps(told, fresh), _mm_andnot_ps(told, old));
  };
  const __m128 new_occupied = chosen(_mm_div_ps(more_occupied, divisor), occupied);
  const __m128 new_empty = chosen(_mm_div_ps(more_empty, divisor), empty);
  _mm_storeu_ps(cells, _mm_unpacklo_ps(new_occupied, new_empty));
  _mm_storeu_ps(cells + 4, _mm_unpackhi_ps(new_occupied, new_empty));
}

}  // namespace

void add_cone(grid::MassCell* tip, std::ptrdiff_t stride, const Cone<float>& cone, std::size_t count,
              ConeReading reading) {
  const auto* const places = cone.places.data();
  const auto* const empties = cone.empty.data();
  const auto* const occupieds = cone.occupied.data();
  const auto* const distances = cone.distance.data();
  const auto cells_of = [=](std::size_t i) { return &cells_at(tip, stride, places[i])->occupied; };
  const std::size_t all_empty = std::min(count, cone.wholly_before(reading.empty_below));
  const __m128 yes = _mm_castsi128_ps(_mm_set1_epi32(-1)), no = _mm_setzero_ps(), nothing[2] = {no, no};
  const auto* const no_weights = reinterpret_cast<const float*>(nothing);
  for (std::size_t i = 0; i < all_empty; ++i) {
    const float* const empty = empties[i].of.data();
    combine_four(cells_of(i), empty, no_weights, yes, no);
    combine_four(cells_of(i) + 8, empty + 4, no_weights, yes, no);
  }
  const __m128i empty_below = _mm_set1_epi16(reading.empty_below);
  const __m128i beyond = _mm_set1_epi16(static_cast<std::int16_t>(reading.occupied_to + 1));
  for (std::size_t i = all_empty; i < count; ++i) {
    float* const cells = cells_of(i);
    const float *const empty = empties[i].of.data(), *const occupied = occupieds[i].of.data();
    const __m128i distance = load(distances[i]);
    const __m128i is_empty = _mm_cmplt_epi16(distance, empty_below), is_near = _mm_cmplt_epi16(distance, beyond);
    combine_four(cells, empty, occupied, _mm_castsi128_ps(_mm_unpacklo_epi16(is_empty, is_empty)),
                 _mm_castsi128_ps(_mm_unpacklo_epi16(is_near, is_near)));
    combine_four(cells + 8, empty + 4, occupied + 4, _mm_castsi128_ps(_mm_unpackhi_epi16(is_empty, is_empty)),
                 _mm_castsi128_ps(_mm_unpackhi_epi16(is_near, is_near)));
  }
}

#else

void add_cone(grid::LogOdds* tip, std::ptrdiff_t stride, const Cone<std::int16_t>& cone, std::size_t count,
              ConeReading reading) {
  add_cone_portably(tip, stride, cone, count, reading);
}

void add_cone(grid::MassCell* tip, std::ptrdiff_t stride, const Cone<float>& cone, std::size_t count,
              ConeReading reading) {
  add_cone_portably(tip, stride, cone, count, reading);
}

#endif

}  // namespace kervan::mapping
