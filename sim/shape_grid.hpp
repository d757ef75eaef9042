/// The broad phase: which shapes are worth asking about. It never answers a question itself.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/shapes.hpp"

namespace kervan::sim {

/// A uniform grid over the bounding box of all shapes; each cell lists the shapes that reach into it.
/// Shapes are numbered: first the segments, then the circles. A shape may be visited more than once.
class ShapeGrid {
 public:
  using Ids = std::span<const std::uint32_t>;

  ShapeGrid(std::span<const Segment> segments, std::span<const Circle> circles);

  /// Calls visit(ids, exit) for the cells the ray passes, nearest first, as far as `range`; `exit` is the distance at
  /// which the ray leaves the cell. Everything the ray can hit before `exit` has then been visited. Ends when visit
  /// returns true.
  template <class Visit>
  void walk(const Ray& ray, double range, Visit&& visit) const;

  /// Calls visit(ids) for every cell that the box from `low` to `high` reaches. Returns true if that was all of them.
  template <class Visit>
  bool visit_box(const Vector2& low, const Vector2& high, Visit&& visit) const;

  double cell_size() const { return cell_; }

 private:
  Ids ids(int column, int row) const {
    const auto cell =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    return {ids_.data() + begin_[cell], ids_.data() + begin_[cell + 1]};
  }
  int column_of(double x) const { return index_of((x - low_.x()) / cell_, columns_); }
  int row_of(double y) const { return index_of((y - low_.y()) / cell_, rows_); }
  static int index_of(double cells, int count) {
    return static_cast<int>(std::clamp(std::floor(cells), 0.0, static_cast<double>(count - 1)));
  }

  Vector2 low_ = Vector2::Zero();
  Vector2 high_ = Vector2::Zero();
  double cell_ = 0.5;
  int columns_ = 0;  // 0 when there are no shapes
  int rows_ = 0;
  std::vector<std::uint32_t> begin_;  // of each cell in ids_, and one past the last
  std::vector<std::uint32_t> ids_;
};

template <class Visit>
void ShapeGrid::walk(const Ray& ray, double range, Visit&& visit) const {
  if (columns_ == 0) return;
  const Vector2& o = ray.origin;
  const Vector2& d = ray.direction;
  // A direction of 0 gives slopes of infinity, which the minima and maxima below pass over as they should.
  const double per_x = 1.0 / d.x(), per_y = 1.0 / d.y();

  double enter = 0.0, leave = range;
  if (o.x() < low_.x() || o.x() > high_.x() || o.y() < low_.y() || o.y() > high_.y()) {
    const auto clip = [&](double origin, double direction, double per, double low, double high) {
      if (direction == 0.0) {
        if (origin < low || origin > high) leave = -1.0;
        return;
      }
      enter = std::max(enter, std::min((low - origin) * per, (high - origin) * per));
      leave = std::min(leave, std::max((low - origin) * per, (high - origin) * per));
    };
    clip(o.x(), d.x(), per_x, low_.x(), high_.x());
    clip(o.y(), d.y(), per_y, low_.y(), high_.y());
    if (enter > leave) return;
  }

  // Amanatides and Woo, A fast voxel traversal algorithm for ray tracing, 1987.
  int column = column_of(o.x() + enter * d.x());
  int row = row_of(o.y() + enter * d.y());
  const int step_x = d.x() < 0.0 ? -1 : 1, step_y = d.y() < 0.0 ? -1 : 1;
  const auto border = [this](double low, int cell, int step) { return low + cell_ * (step > 0 ? cell + 1 : cell); };
  double exit_x = d.x() == 0.0 ? infinity : (border(low_.x(), column, step_x) - o.x()) * per_x;
  double exit_y = d.y() == 0.0 ? infinity : (border(low_.y(), row, step_y) - o.y()) * per_y;
  const double stride_x = cell_ * std::abs(per_x), stride_y = cell_ * std::abs(per_y);
  for (;;) {
    const double exit = std::min(exit_x, exit_y);
    if (visit(ids(column, row), exit) || exit >= leave) return;
    if (exit_x < exit_y) {
      exit_x += stride_x;
      column += step_x;
      if (column < 0 || column >= columns_) return;
    } else {
      exit_y += stride_y;
      row += step_y;
      if (row < 0 || row >= rows_) return;
    }
  }
}

template <class Visit>
bool ShapeGrid::visit_box(const Vector2& low, const Vector2& high, Visit&& visit) const {
  if (columns_ == 0) return true;
  const bool all = low.x() <= low_.x() && low.y() <= low_.y() && high.x() >= high_.x() && high.y() >= high_.y();
  if (low.x() > high_.x() || low.y() > high_.y() || high.x() < low_.x() || high.y() < low_.y()) return all;
  const int last_column = column_of(high.x()), last_row = row_of(high.y());
  for (int row = row_of(low.y()); row <= last_row; ++row)
    for (int column = column_of(low.x()); column <= last_column; ++column) visit(ids(column, row));
  return all;
}

}  // namespace kervan::sim
