/// The cells of a sonar's cone, with what a reading says about each, computed once for every heading.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "components/grid/cells.hpp"
#include "components/mapping/headings.hpp"
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

/// Distances in rising order, mm, and how many of them are within another.
class Distances {
 public:
  Distances() = default;
  /// At most 65535.
  explicit Distances(std::vector<std::int16_t> rising);

  std::size_t size() const { return values_.size(); }
  std::int16_t operator[](std::size_t i) const { return values_[i]; }

  /// How many are not above `limit`.
  std::size_t up_to(int limit) const {
    if (limit < 0 || values_.empty()) return 0;
    const auto part = static_cast<std::size_t>(limit) / part_length;
    if (part >= begins_.size()) return values_.size();
    std::size_t count = begins_[part];
    while (count < values_.size() && values_[count] <= limit) ++count;
    return count;
  }

 private:
  static constexpr std::size_t part_length = 64;  // mm: a few values lie in each

  std::vector<std::int16_t> values_;
  std::vector<std::uint16_t> begins_;  // how many lie below each part
};

/// The cone with its axis in one direction, its tip in the middle of cell (0, 0): eights of cells in the order of their
/// nearest one, so that a short reading ends early. Cells of an eight that are not in the cone are never reached, and
/// have weights of zero. The tables lie apart, since most cells of a reading are told to be empty and need one of them
/// only: what a reading costs is the memory it looks at.
template <class Weight>
struct Cone {
  /// Of a cell from the tip's.
  struct Place {
    std::int16_t x, y;
  };

  std::vector<Eight<Weight>> empty;           ///< what Region II says
  std::vector<Eight<Weight>> occupied;        ///< what Region I says
  std::vector<Eight<std::int16_t>> distance;  ///< of the cells' centres from the transducer, mm
  std::vector<Place> places;                  ///< of the first cell of each eight
  Distances nearest;                          ///< of the nearest cell of each eight
  Distances within;                  ///< distance that all cells of an eight, and of those before it, are within
  std::vector<grid::CellBox> boxes;  ///< around the first one, the first two, …

  /// How many eights have cells up to a distance, mm.
  std::size_t up_to(int distance_mm) const { return nearest.up_to(distance_mm); }
  /// How many, from the first on, have all of their cells nearer than that.
  std::size_t wholly_before(int distance_mm) const { return within.up_to(distance_mm - 1); }
};

/// A cone as it lies in the map.
template <class Weight>
struct PlacedCone {
  const Cone<Weight>& cone;
  bool mirrored;           ///< its rows count downwards
  geometry::Vector2 axis;  ///< of length 1

  grid::CellBox box(std::size_t eights) const {
    grid::CellBox box = cone.boxes[eights - 1];
    if (mirrored) box.y = 1 - box.y - box.rows;
    return box;
  }
  /// Of a grid whose rows are `stride` apart.
  std::ptrdiff_t stride(std::ptrdiff_t stride) const { return mirrored ? -stride : stride; }
};

/// Cones for all headings; each is computed when it is first asked for. Those of the
/// lower half are those of the upper one mirrored, cell for cell: one table does for both.
template <class Weight>
class ConeStencil {
 public:
  /// What a cell's region says, from its distance r, m, and its angle α off the axis, rad; 0 says nothing.
  using Weigh = Weight (*)(const SonarModel& model, double r, double alpha);

  /// Throws std::invalid_argument if the model reaches farther than farthest_cone, or over more than 32767 cells.
  ConeStencil(const SonarModel& model, double resolution, Weigh empty, Weigh occupied);

  /// The cone whose axis is nearest to `yaw`, at most 0.7 degrees away.
  PlacedCone<Weight> at(double yaw) { return cone(Headings::nearest(yaw)); }

  /// `heading`: 0 .. Headings::count - 1.
  PlacedCone<Weight> cone(int heading);

 private:
  Cone<Weight> made(int heading) const;

  SonarModel model_;
  double resolution_;
  Weigh empty_;
  Weigh occupied_;
  Headings headings_;
  std::vector<std::unique_ptr<Cone<Weight>>> cones_;  // of the upper half
};

extern template class ConeStencil<std::int16_t>;
extern template class ConeStencil<float>;

}  // namespace kervan::mapping
