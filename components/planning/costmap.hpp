/// What it costs a round robot to be in each cell of a map.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "components/grid/occupancy.hpp"
#include "components/planning/blocked_bits.hpp"

namespace kervan::planning {

/// Moves from a cell to its neighbours, counter-clockwise from +x; even ones are straight.
inline constexpr int directions = 8;
inline constexpr std::array<int, directions> step_x = {1, 1, 0, -1, -1, -1, 0, 1};
inline constexpr std::array<int, directions> step_y = {0, 1, 1, 1, 0, -1, -1, -1};

struct CostmapParams {
  double radius = 0.25;          ///< m; no place of the robot's centre is nearer to an obstacle than this
  double clearance = 0.30;       ///< m; beyond the radius, where being near an obstacle still costs something
  double clearance_cost = 3.0;   ///< 0 .. 14; what a metre costs more right at the radius; falls as a parabola
  double occupied_above = 50.0;  ///< per cent; a cell above it is an obstacle
  bool unknown_is_free = true;   ///< else it is an obstacle
};

/// Weights of the cells, with all that a search asks of a cell in two bytes of it. A cell is blocked if its centre is
/// nearer than `radius` to an obstacle, which is a whole square: the distance is exact, not one of centres. So a line
/// that touches no blocked cell, not even with a corner, keeps the robot's centre at least radius - 0.71 cells from
/// every obstacle. The square of the distance falls apart into rows and columns (Felzenszwalb and Huttenlocher 2012,
/// "Distance Transforms of Sampled Functions", doi:10.4086/toc.2012.v008a019); since it is only asked up to radius +
/// clearance, a change of the map is felt no farther than that.
///
/// Cells are counted from 1; around them lies a border of blocked ones, so that every free cell has eight neighbours.
class Costmap {
 public:
  static constexpr std::uint8_t occupied = 0;  ///< weight of an obstacle
  static constexpr std::uint8_t inflated = 1;  ///< weight of a cell too near to one
  static constexpr std::uint8_t lightest = 8;  ///< weight of a cell that costs its length, in eighths
  static constexpr int heaviest = 127;         ///< most that fits
  static constexpr double most_clearance_cost = 14.0;
  static constexpr int widest = 65'000;  ///< cells along a side

  explicit Costmap(const CostmapParams& params) : params_(params) {}

  /// Follows the map within `box`, which is part of it: where it has changed since the last call, or everywhere if the
  /// box is another one. Throws std::invalid_argument if a side has more cells than `widest`.
  void update(grid::Occupancy& map, const grid::CellBox& box);

  const CostmapParams& params() const { return params_; }
  double resolution() const { return resolution_; }    ///< m, side of a cell
  const grid::CellBox& box() const { return box_; }    ///< in cells of the map
  bool uniform() const { return !weighs_distance(); }  ///< no free cell is dearer than another

  int columns() const { return box_.columns; }
  int rows() const { return box_.rows; }
  std::uint32_t stride() const { return stride_; }     ///< from a cell to the one above it
  std::size_t cells() const { return cells_.size(); }  ///< border included
  std::uint32_t index(int x, int y) const {
    return static_cast<std::uint32_t>(y) * stride_ + static_cast<std::uint32_t>(x);
  }
  bool contains(int x, int y) const { return x >= 1 && y >= 1 && x <= box_.columns && y <= box_.rows; }

  std::uint8_t weight(std::uint32_t cell) const { return weights_[cell]; }
  bool blocked(std::uint32_t cell) const { return weights_[cell] < lightest; }

  /// For each cell: bits 0 .. 7 which moves are allowed, those past the corner of a blocked cell not; `flat` if all
  /// free cells of the nine around it have its weight; from `weight_shift` on its weight, 0 if it is blocked.
  const std::uint16_t* infos() const { return cells_.data(); }
  static constexpr unsigned flat = 1u << 8;
  static constexpr unsigned weight_shift = 9;

  const BlockedBits& row_bits() const { return row_bits_; }        ///< a row's cells side by side
  const BlockedBits& column_bits() const { return column_bits_; }  ///< a column's cells side by side

  /// In cells, as the searches count them: the middle of cell (1, 1) is (1.5, 1.5).
  geometry::Vector2 to_cells(const geometry::Vector2& point) const {
    return point / resolution_ - geometry::Vector2(box_.x - 1, box_.y - 1);
  }
  geometry::Vector2 from_cells(const geometry::Vector2& point) const {
    return (point + geometry::Vector2(box_.x - 1, box_.y - 1)) * resolution_;
  }

 private:
  bool weighs_distance() const { return params_.clearance > 0.0 && params_.clearance_cost > 0.0; }
  void begin(const grid::CellBox& box, double resolution);
  grid::CellBox turned(const grid::Occupancy& map, const grid::CellBox& where) const;
  void weigh(const grid::Occupancy& map, const grid::CellBox& changed);
  void measure_columns(const grid::Occupancy& map, const grid::CellBox& from, const grid::CellBox& to);
  void measure_row(int width, int margin_left, int to_width, const std::int32_t* squares, std::uint8_t* weights);
  void note(const grid::CellBox& changed);

  CostmapParams params_;
  double resolution_ = 0.0;
  grid::CellBox box_;
  std::uint32_t stride_ = 0;
  int reach_ = 0;                        // cells, farther than which nothing is felt
  std::vector<std::uint8_t> weight_of_;  // by the square of the distance, in half cells
  std::vector<std::uint8_t> weights_;
  std::vector<std::uint16_t> cells_;
  BlockedBits row_bits_;
  BlockedBits column_bits_;
  std::vector<std::int32_t> squares_;  // of a part of the map: distances along its columns, in half cells
  std::vector<std::int32_t> nearest_;  // of one row
};

}  // namespace kervan::planning
