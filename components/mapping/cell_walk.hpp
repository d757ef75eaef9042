/// The cells along a ray, one neighbour after the other.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "components/grid/cells.hpp"

namespace kervan::mapping {

/// A digital differential analyser: one cell for each step along the ray's longer axis, from the middle of the first
/// cell to the one that holds the ray's end. Mirrored rays have mirrored cells.
class CellWalk {
 public:
  /// `direction`: of length 1; `length`: of the ray, in cells, not negative and at most 2^20.
  CellWalk(const grid::Cell& from, const geometry::Vector2& direction, double length) : from_(from) {
    const double dx = length * direction.x(), dy = length * direction.y();
    along_x_ = std::abs(dx) >= std::abs(dy);
    const double major = along_x_ ? dx : dy, minor = along_x_ ? dy : dx;
    steps_ = static_cast<int>(std::abs(major) + 0.5);
    major_sign_ = major < 0.0 ? -1 : 1;
    minor_sign_ = minor < 0.0 ? -1 : 1;
    slope_ = steps_ == 0 ? 0 : static_cast<std::int64_t>(std::abs(minor / major) * one);
  }

  grid::Cell cell() const { return cell(at_, minor_); }
  bool at_end() const { return at_ == steps_; }
  void step() {
    ++at_;
    minor_ += slope_;
  }

  /// use(cell) for each cell but the last one, whose place it returns. `first`: the place of the first one in a grid
  /// that holds them all and whose rows are `stride` apart. For a walk that has not begun.
  template <class Value, class Use>
  Value* over(Value* first, std::ptrdiff_t stride, Use use) const {
    std::ptrdiff_t ahead = major_sign_ * (along_x_ ? 1 : stride);
    const std::ptrdiff_t aside = minor_sign_ * (along_x_ ? stride : 1);
    if (slope_ == static_cast<std::int64_t>(one)) ahead += aside;
    const auto slope = static_cast<std::uint32_t>(slope_);
    auto minor = static_cast<std::uint32_t>(half);
    for (int left = steps_; left > 0; --left) {
      use(*first);
      minor += slope;
      first += ahead + (minor < slope ? aside : 0);  // what is carried over is a step to the side
    }
    return first;
  }

  /// Around all of its cells.
  grid::CellBox box() const {
    const grid::Cell end = cell(steps_, half + slope_ * steps_);
    return grid::united({from_.x, from_.y, 1, 1}, {end.x, end.y, 1, 1});
  }

 private:
  static constexpr double one = 4294967296.0;  // of the fixed point numbers below, which have 32 digits behind it
  static constexpr std::int64_t half = std::int64_t{1} << 31;

  grid::Cell cell(int major, std::int64_t minor) const {
    const int a = major_sign_ * major, b = minor_sign_ * static_cast<int>(minor >> 32);
    return along_x_ ? grid::Cell{from_.x + a, from_.y + b} : grid::Cell{from_.x + b, from_.y + a};
  }

  grid::Cell from_;
  bool along_x_ = true;
  int major_sign_ = 1, minor_sign_ = 1;
  int steps_ = 0;
  int at_ = 0;
  std::int64_t slope_ = 0;
  std::int64_t minor_ = half;
};

}  // namespace kervan::mapping
