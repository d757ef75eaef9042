/// How well the end of an echo lies in a map: near what is occupied.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "components/localization/point_map.hpp"

namespace kervan::localization {

/// The likelihood field of a rectangle of a map (Thrun, Burgard and Fox 2005, "Probabilistic Robotics", section 6.4):
/// 255 where a surely occupied cell's echoes came from, falling off with the distance from there as a Gaussian; 0 far
/// from everything.
class LikelihoodField {
 public:
  /// How many cells to the right and above the bound of a cell looks at.
  static constexpr int bound_side = 4;

  /// `sigma`: of the Gaussian, in cells.
  explicit LikelihoodField(double sigma);

  void build(const PointMap& map, const grid::CellBox& box);

  const grid::CellBox& box() const { return box_; }

  /// How far from an occupied cell the field is more than 0, in cells.
  int reach() const { return reach_; }

  /// The place of a cell, which must be in the box, in values() and bounds(); that of the cell above is stride() more.
  std::size_t index(const grid::Cell& cell) const {
    return static_cast<std::size_t>(cell.y - box_.y) * static_cast<std::size_t>(box_.columns) +
           static_cast<std::size_t>(cell.x - box_.x);
  }
  std::ptrdiff_t stride() const { return box_.columns; }

  const std::vector<std::uint8_t>& values() const { return values_; }

  /// The largest value of the cell itself and those up to bound_side - 1 to the right of and above it.
  const std::vector<std::uint8_t>& bounds() const { return bounds_; }

  /// Whether the map says anything that an echo from this cell could be compared with: it knows the cell, or something
  /// occupied in reach.
  bool tells(const grid::Cell& cell) const {
    return box_.contains(cell) && (known_[index(cell)] != 0 || values_[index(cell)] > 0);
  }

 private:
  void stamp(int column, int row, const PointCell& cell);
  void find_bounds();

  double sigma_;
  int reach_;
  std::vector<float> across_;  // of one Gaussian, along a row
  grid::CellBox box_;
  std::vector<std::uint8_t> known_;
  std::vector<std::uint8_t> values_;
  std::vector<std::uint8_t> bounds_;
  std::vector<std::uint8_t> sideways_;
};

}  // namespace kervan::localization
