/// Rays over a raster of solid cells: the innermost loop of every sensor, once for each set of instructions.
///
/// Quadrant box skip: a ray jumps to the exit of the largest empty square ahead of it (skip_tables.hpp) until it stands
/// in a solid cell. All kernels do the same operations on single precision numbers in the same order, none of them
/// fused, so that their results are equal to the last bit.
///
/// The kernels are compiled for processors that this one may not be. This header therefore holds plain data and
/// declarations only: an inline function would exist once in the program, in whichever version the linker takes.
#pragma once

#include <cstdint>

namespace kervan::sim {

/// Rays from one point and what they meet.
struct RayFan {
  // The raster: SkipTables.
  const std::uint8_t* skips;
  std::int32_t columns, rows;
  // Cells per metre: (x, y) of a direction in cells is (xx dx + xy dy, yx dx + yy dy).
  float xx, xy, yx, yy;
  // The origin: its cell, which lies in the raster, and its place there, 0 .. 1.
  std::int32_t column, row;
  float x, y;
  float range;  ///< m; rays end here
  // The rays: unit vectors.
  const float* dx;
  const float* dy;
  std::int32_t count;
  // The results: distance in m, infinity without a hit, and which edge of the cell was met.
  float* distance;
  std::int32_t* face;
};

/// Values of RayFan::face; without a hit it has no meaning.
enum Face : std::int32_t { within_cell = 0, across_x = 1, across_y = 2 };

enum class Instructions { scalar, avx2, avx512 };

/// True if this build and this processor have them; `scalar` always.
bool available(Instructions instructions);

/// The widest that are available.
Instructions widest();

/// Casts the fan. The instructions must be available.
void cast(const RayFan& fan, Instructions instructions);

namespace kernel {
void cast_scalar(const RayFan& fan);
void cast_avx2(const RayFan& fan);
void cast_avx512(const RayFan& fan);
}  // namespace kernel

}  // namespace kervan::sim
