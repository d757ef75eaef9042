/// Rays over a raster of solid cells and past discs: the innermost loops of every sensor, once for each set of
/// instructions.
///
/// Quadrant box skip: a ray jumps to the exit of the largest empty square ahead of it (skip_tables.hpp) until it stands
/// in a solid cell. All kernels do the same operations on single precision numbers in the same order, none of them
/// fused, so that their results are equal to the last bit.
///
/// The kernels are compiled for processors that this one may not be. This header therefore holds plain data and
/// declarations only: an inline function would exist once in the program, in whichever version the linker takes.
#pragma once

#include <cstddef>
#include <cstdint>

namespace kervan::sim {

/// So many rays are on their way at once: enough to wait for memory together, few enough to be kept on the stack.
inline constexpr std::size_t most_rays = 256;

/// Rays and what they meet.
struct RayBatch {
  // The raster: SkipTables.
  const std::uint8_t* skips;
  std::int32_t columns, rows;
  // Cells per metre: (x, y) of a direction in cells is (xx dx + xy dy, yx dx + yy dy).
  float xx, xy, yx, yy;
  float range;  ///< m; rays end here
  // The rays. The origin of each: its cell, which lies in the raster, and its place there, 0 .. 1.
  const std::int32_t* column;
  const std::int32_t* row;
  const float* x;
  const float* y;
  // And its direction, a unit vector.
  const float* dx;
  const float* dy;
  std::int32_t count;
  // The results: distance in m, infinity without a hit, and which edge of the cell was met.
  float* distance;
  std::int32_t* face;
};

/// Rays of which is asked whether they pass a disc; metres, from a point near them.
struct RayPaths {
  const float* x;  ///< the origin
  const float* y;
  const float* dx;  ///< the direction, a unit vector
  const float* dy;
  const float* length;
  std::int32_t count;  ///< rounded up to a multiple of 16, all arrays are that long
};

/// Values of RayBatch::face; without a hit it has no meaning.
enum Face : std::int32_t { within_cell = 0, across_x = 1, across_y = 2 };

enum class Instructions { scalar, avx2, avx512 };

/// True if this build and this processor have them; `scalar` always.
bool available(Instructions instructions);

/// The widest that are available.
Instructions widest();

/// Casts the rays. The instructions must be available.
void cast(const RayBatch& rays, Instructions instructions);

/// Which rays come as near as `radius` to the point, single precision: bit k of near[j] stands for ray 16 j + k. Bits
/// of rays that are none mean nothing.
void find_near(const RayPaths& rays, float x, float y, float radius, std::uint16_t* near, Instructions instructions);

namespace kernel {
void cast_scalar(const RayBatch& rays);
void cast_avx2(const RayBatch& rays);
void cast_avx512(const RayBatch& rays);
void find_near_scalar(const RayPaths& rays, float x, float y, float radius, std::uint16_t* near);
void find_near_avx2(const RayPaths& rays, float x, float y, float radius, std::uint16_t* near);
void find_near_avx512(const RayPaths& rays, float x, float y, float radius, std::uint16_t* near);
}  // namespace kernel

}  // namespace kervan::sim
