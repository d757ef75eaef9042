/// The cells of a sonar's cone, with what a reading says about each, computed once for every heading.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "components/grid/cells.hpp"
#include "components/mapping/sonar_model.hpp"

namespace kervan::mapping {

/// Distance of cells that are not in the cone, mm.
inline constexpr std::int16_t never_reached = 32767;

/// Longest range of a stencil, m: distances are millimetres in sixteen bits.
inline constexpr double farthest_cone = 32.0;

/// Of eight neighbouring cells of a row, as many as sixteen-bit vector instructions take at once.
template <class Value>
struct alignas(16) Eight {
  std::array<Value, 8> of;
};

/// The cone with its axis in one direction, its tip in the middle of cell (0, 0): eights of cells in the order of their
/// nearest one, so that a short reading ends early. Cells of an eight that are not in the cone are never reached, and
/// have weights of zero. The tables lie apart, since most cells of a reading are told to be empty and need one of them
/// only: what a reading costs is the memory it looks at.
template <class Weight>
struct Cone {
  std::vector<Eight<Weight>> empty;           ///< what Region II says
  std::vector<Eight<Weight>> occupied;        ///< what Region I says
  std::vector<Eight<std::int16_t>> distance;  ///< of the cells' centres from the transducer, mm
  std::vector<grid::Cell> places;             ///< of the first cell of each eight
  std::vector<std::int16_t> nearest;          ///< distance of the nearest cell of each, mm
  std::vector<std::int16_t> within;  ///< distance that all cells of an eight, and of those before it, are within
  std::vector<grid::CellBox> boxes;  ///< around the first one, the first two, …

  /// How many eights have cells up to a distance, mm.
  std::size_t up_to(int distance_mm) const;
  /// How many, from the first on, have all of their cells nearer than that.
  std::size_t wholly_before(int distance_mm) const;
};

/// Cones for `headings` directions evenly round the circle; each is computed when it is first asked for. Mirrored
/// headings have mirrored cones, cell for cell.
template <class Weight>
class ConeStencil {
 public:
  static constexpr int headings = 256;

  /// What a cell's region says, from its distance r, m, and its angle α off the axis, rad; 0 says nothing.
  using Weigh = Weight (*)(const SonarModel& model, double r, double alpha);

  /// Throws std::invalid_argument if the model reaches farther than farthest_cone.
  ConeStencil(const SonarModel& model, double resolution, Weigh empty, Weigh occupied);

  /// The cone whose axis is nearest to `yaw`, at most 0.7 degrees away.
  const Cone<Weight>& at(double yaw) { return cone(heading_of(yaw)); }

  /// 0 .. headings - 1; 0 is along x.
  static int heading_of(double yaw);

  const Cone<Weight>& cone(int heading);

 private:
  Cone<Weight> made(int heading) const;

  SonarModel model_;
  double resolution_;
  Weigh empty_;
  Weigh occupied_;
  std::vector<std::unique_ptr<Cone<Weight>>> cones_;
};

extern template class ConeStencil<std::int16_t>;
extern template class ConeStencil<float>;
extern template struct Cone<std::int16_t>;
extern template struct Cone<float>;

}  // namespace kervan::mapping
