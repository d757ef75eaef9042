/// Draws places to drive to, at random.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "framework/geometry/pose2.hpp"

namespace kervan::exploration {

/// What stands around; m, in the map's frame.
struct Obstacles {
  struct Circle {
    geometry::Vector2 center;
    double radius;
  };
  /// Open lines: walls.
  struct Wall {
    geometry::Vector2 a, b;
  };
  std::vector<Wall> walls;
  std::vector<Circle> circles;
  std::vector<std::vector<geometry::Vector2>> polygons;  ///< solid, convex or not

  /// From a point to the nearest of them, m: 0 within a solid one, infinity where there is none.
  double distance(const geometry::Vector2& point) const;
};

/// A rectangle by two opposite corners, m.
struct Area {
  geometry::Vector2 low = geometry::Vector2::Zero();
  geometry::Vector2 high = geometry::Vector2::Zero();
};

/// The smallest one around all obstacles; nothing if there are none.
std::optional<Area> area_around(const Obstacles& obstacles);

/// Target number `k` of a seed: uniform over the places of the area from which it is at least `room`, m, to the nearest
/// obstacle. It depends on these values and on nothing else: not on who asks, how often and in which order. Nothing if
/// no such place was found among 10,000.
std::optional<geometry::Vector2> draw_target(std::uint64_t seed, std::uint64_t k, const Area& area,
                                             const Obstacles& obstacles, double room);

/// In [0, 1), a multiple of 2^-53: number `k`, `j` of the sequence of `seed`. Three rounds of the finaliser of
/// SplitMix64 (Steele, Lea and Flood 2014, doi:10.1145/2714064.2660195).
double uniform(std::uint64_t seed, std::uint64_t k, std::uint64_t j);

}  // namespace kervan::exploration
