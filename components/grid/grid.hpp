/// A map of square cells that grows where it is needed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "components/grid/cells.hpp"

namespace kervan::grid {

enum class Growth {
  fits,     ///< the cells were there
  grown,    ///< they are there now; pointers into the grid are invalid
  refused,  ///< it would take more memory than allowed; nothing has changed
};

/// One value for each cell of a rectangle, row by row from the lowest one (row-major, x fastest). The rectangle is made
/// of whole tiles, and grows in every direction; the values of new cells are `unknown`. Which tiles have changed is
/// remembered until somebody asks.
template <class Value>
class Grid {
 public:
  /// `resolution`: side of a cell, m. `most_bytes`: that the values may take.
  Grid(double resolution, Value unknown, std::size_t most_bytes)
      : resolution_(resolution), unknown_(unknown), most_bytes_(most_bytes) {}

  double resolution() const { return resolution_; }
  Value unknown() const { return unknown_; }
  std::size_t most_bytes() const { return most_bytes_; }
  const CellBox& box() const { return box_; }
  const std::vector<Value>& values() const { return values_; }

  /// `unknown` outside of the box.
  Value at(const Cell& cell) const { return box_.contains(cell) ? values_[index(cell)] : unknown_; }

  /// The cell's place; it must be in the box. The cells of its row follow and precede it.
  Value* place(const Cell& cell) { return values_.data() + index(cell); }
  const Value* place(const Cell& cell) const { return values_.data() + index(cell); }

  /// From a cell to the one above it.
  std::ptrdiff_t stride() const { return box_.columns; }

  /// Makes all cells of `wanted` exist. Growing takes a quarter more than it must, if the memory allows, so that a map
  /// that grows steadily is not copied at every step.
  Growth cover(const CellBox& wanted) {
    if (box_.contains(wanted)) return Growth::fits;
    const Span x = {wanted.x, std::int64_t{wanted.x} + wanted.columns};
    const Span y = {wanted.y, std::int64_t{wanted.y} + wanted.rows};
    const Span old_x = {box_.x, std::int64_t{box_.x} + box_.columns},
               old_y = {box_.y, std::int64_t{box_.y} + box_.rows};
    for (const int slack : {4, 0}) {
      const Span new_x = grown(old_x, x, slack), new_y = grown(old_y, y, slack);
      if (!fits(new_x.end - new_x.begin, new_y.end - new_y.begin)) continue;
      move_to({static_cast<int>(new_x.begin), static_cast<int>(new_y.begin), static_cast<int>(new_x.end - new_x.begin),
               static_cast<int>(new_y.end - new_y.begin)});
      return Growth::grown;
    }
    return Growth::refused;
  }

  /// Values within `changed`, which is in the box, may have changed.
  void touch(const CellBox& changed) {
    const int columns = box_.columns / tile_side, left = box_.x / tile_side, bottom = box_.y / tile_side;
    for (int y = tile_of(changed.y); y <= tile_of(changed.y + changed.rows - 1); ++y)
      for (int x = tile_of(changed.x); x <= tile_of(changed.x + changed.columns - 1); ++x)
        touched_[static_cast<std::size_t>((y - bottom) * columns + x - left)] = 1;
  }

  /// The tiles touched since the last call, from the lower left one, row by row.
  std::vector<Cell> take_touched() {
    std::vector<Cell> tiles;
    const int columns = box_.columns / tile_side;
    for (std::size_t i = 0; i < touched_.size(); ++i)
      if (std::exchange(touched_[i], std::uint8_t{0}) != 0)
        tiles.push_back(
            {box_.x / tile_side + static_cast<int>(i) % columns, box_.y / tile_side + static_cast<int>(i) / columns});
    return tiles;
  }

 private:
  struct Span {
    std::int64_t begin, end;
  };

  std::size_t index(const Cell& cell) const {
    return static_cast<std::size_t>(cell.y - box_.y) * static_cast<std::size_t>(box_.columns) +
           static_cast<std::size_t>(cell.x - box_.x);
  }

  /// Whole tiles around both; on a side where it grows, by one `slack`-th of what there is at least.
  static Span grown(const Span& old, const Span& wanted, int slack) {
    const auto down = [](std::int64_t cell) {
      return (cell >= 0 ? cell / tile_side : -((-cell - 1) / tile_side) - 1) * tile_side;
    };
    const auto up = [&](std::int64_t cell) { return -down(-cell); };
    if (old.begin == old.end) return {down(wanted.begin), up(wanted.end)};
    const std::int64_t more = slack == 0 ? 0 : (old.end - old.begin) / slack;
    Span span = old;
    if (wanted.begin < old.begin) span.begin = down(std::min(wanted.begin, old.begin - more));
    if (wanted.end > old.end) span.end = up(std::max(wanted.end, old.end + more));
    return span;
  }

  bool fits(std::int64_t columns, std::int64_t rows) const {
    const auto most = static_cast<std::int64_t>(most_bytes_ / sizeof(Value));
    return columns <= most && rows <= most / columns;
  }

  void move_to(const CellBox& box) {
    std::vector<Value> values(static_cast<std::size_t>(box.columns) * static_cast<std::size_t>(box.rows), unknown_);
    std::vector<std::uint8_t> touched(values.size() / (tile_side * tile_side), std::uint8_t{0});
    std::swap(values, values_);
    std::swap(touched, touched_);
    const CellBox old = std::exchange(box_, box);
    for (int row = 0; row < old.rows; ++row)
      std::copy_n(values.begin() + std::ptrdiff_t{row} * old.columns, old.columns, place({old.x, old.y + row}));
    for (std::size_t i = 0; i < touched.size(); ++i) {
      const int columns = old.columns / tile_side, tile = static_cast<int>(i);
      if (touched[i] != 0)
        touch(cells_of_tile({old.x / tile_side + tile % columns, old.y / tile_side + tile / columns}));
    }
  }

  double resolution_;
  Value unknown_;
  std::size_t most_bytes_;
  CellBox box_;
  std::vector<Value> values_;
  std::vector<std::uint8_t> touched_;  // one for each tile
};

}  // namespace kervan::grid
