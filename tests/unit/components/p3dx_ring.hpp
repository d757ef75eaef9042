/// The sonars of a Pioneer P3-DX, for tests of behaviours.
#pragma once

#include <array>
#include <initializer_list>
#include <utility>

#include "components/behavior/situation.hpp"

namespace kervan::test {

/// x and y in mm, direction in degrees (AriaCoda, params/p3dx.p).
inline constexpr std::array<std::array<double, 3>, behavior::ring_size> p3dx_poses{{{69, 136, 90},
                                                                                    {114, 119, 50},
                                                                                    {148, 78, 30},
                                                                                    {166, 27, 10},
                                                                                    {166, -27, -10},
                                                                                    {148, -78, -30},
                                                                                    {114, -119, -50},
                                                                                    {69, -136, -90},
                                                                                    {-157, -136, -90},
                                                                                    {-203, -119, -130},
                                                                                    {-237, -78, -150},
                                                                                    {-255, -27, -170},
                                                                                    {-255, 27, 170},
                                                                                    {-237, 78, 150},
                                                                                    {-203, 119, 130},
                                                                                    {-157, 136, 90}}};

using Ranges = std::initializer_list<std::pair<int, double>>;  ///< number of the transducer, m

/// Nothing is heard but what `ranges` say.
inline behavior::SonarRing p3dx_ring(Ranges ranges = {}) {
  behavior::SonarRing ring;
  for (std::size_t i = 0; i < ring.size(); ++i)
    ring[i].transducer = {1e-3 * p3dx_poses[i][0], 1e-3 * p3dx_poses[i][1], geometry::radians(p3dx_poses[i][2])};
  for (const auto& [number, range] : ranges) ring[static_cast<std::size_t>(number)].range = range;
  return ring;
}

}  // namespace kervan::test
