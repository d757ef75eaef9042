/// How far a ray may jump over a raster without looking: for every cell and every direction, the largest empty square
/// ahead of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kervan::sim {

/// Four tables, one for each quadrant that a ray may travel into: +x +y, -x +y, +x -y, -x -y. Each is mirrored so that
/// in it every ray travels towards larger columns and rows. An entry is the side, in cells and at most 255, of the
/// largest square without a blocked cell whose lowest corner is the entry's cell; 0 where the cell itself is blocked.
/// Beyond the last column and the last row stands one more of zeros, at which every ray ends. 4 bytes for each cell.
class SkipTables {
 public:
  /// `blocked` row by row from the lowest; 0 is free.
  SkipTables(int columns, int rows, std::span<const std::uint8_t> blocked);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  std::size_t stride() const { return static_cast<std::size_t>(columns_) + 1; }           ///< from row to row
  std::size_t plane() const { return stride() * (static_cast<std::size_t>(rows_) + 1); }  ///< from table to table
  const std::uint8_t* data() const { return entries_.data(); }  ///< may be read three bytes beyond the last table

  bool blocked(int column, int row) const { return entry(0, column, row) == 0; }

  /// The entry of a table at mirrored coordinates.
  int entry(int quadrant, int column, int row) const {
    return entries_[static_cast<std::size_t>(quadrant) * plane() + static_cast<std::size_t>(row) * stride() +
                    static_cast<std::size_t>(column)];
  }

  /// The clearance field: so many cells around a cell are free in every direction, the cell itself being the first.
  /// 0 where it is blocked. The border of the raster counts as blocked.
  int free_around(int column, int row) const;

 private:
  int columns_;
  int rows_;
  std::vector<std::uint8_t> entries_;
};

}  // namespace kervan::sim
