#include "sim/shape_grid.hpp"

namespace kervan::sim {

namespace {

constexpr double usual_cell = 0.5;  // metres: about the size of a robot
constexpr double most_cells = 1e6;  // a larger world gets larger cells
constexpr double margin = 1e-6;     // metres; far more than the rounding of a ray's way through the cells

struct Bounds {
  Vector2 low, high;
};

Bounds bounds(const Segment& s) { return {s.a.cwiseMin(s.b), s.a.cwiseMax(s.b)}; }
Bounds bounds(const Circle& c) {
  const Vector2 extent = Vector2::Constant(c.radius);
  return {c.center - extent, c.center + extent};
}

bool reaches(const Segment& segment, const Vector2& center, double half) {
  // Their bounding boxes meet already, so only the segment's own normal can still separate the two.
  const Vector2 along = segment.b - segment.a;
  return std::abs(cross(along, center - segment.a)) <= half * along.lpNorm<1>();
}

bool reaches(const Circle& circle, const Vector2& center, double half) {
  const Vector2 gap = ((circle.center - center).cwiseAbs() - Vector2::Constant(half)).cwiseMax(0.0);
  return gap.squaredNorm() <= circle.radius * circle.radius;
}

}  // namespace

ShapeGrid::ShapeGrid(std::span<const Segment> segments, std::span<const Circle> circles) {
  if (segments.empty() && circles.empty()) {
    return;
  }
  low_ = Vector2::Constant(infinity);
  high_ = Vector2::Constant(-infinity);
  const auto grow = [this](const Bounds& b) {
    low_ = low_.cwiseMin(b.low);
    high_ = high_.cwiseMax(b.high);
  };
  for (const Segment& s : segments) grow(bounds(s));
  for (const Circle& c : circles) grow(bounds(c));
  low_.array() -= 2.0 * margin;
  high_.array() += 2.0 * margin;

  const Vector2 extent = high_ - low_;
  cell_ = std::max({usual_cell, std::sqrt(extent.x() * extent.y() / most_cells), extent.maxCoeff() / most_cells});
  columns_ = static_cast<int>(std::ceil(extent.x() / cell_));
  rows_ = static_cast<int>(std::ceil(extent.y() / cell_));

  // Two passes over the same cells: the first counts, the second writes (compressed rows).
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  begin_.assign(cells + 1, 0);
  const double half = 0.5 * cell_ + margin;
  const auto for_each_entry = [&](auto&& entry) {
    std::uint32_t id = 0;
    const auto enter = [&](const auto& shape) {
      const Bounds b = bounds(shape);
      const int last_column = column_of(b.high.x() + margin), last_row = row_of(b.high.y() + margin);
      for (int row = row_of(b.low.y() - margin); row <= last_row; ++row)
        for (int column = column_of(b.low.x() - margin); column <= last_column; ++column) {
          const Vector2 center = low_ + cell_ * Vector2(column + 0.5, row + 0.5);
          if (reaches(shape, center, half))
            entry(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column),
                  id);
        }
      ++id;
    };
    for (const Segment& s : segments) enter(s);
    for (const Circle& c : circles) enter(c);
  };
  for_each_entry([this](std::size_t cell, std::uint32_t) { ++begin_[cell + 1]; });
  for (std::size_t cell = 0; cell < cells; ++cell) begin_[cell + 1] += begin_[cell];
  ids_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for_each_entry([&](std::size_t cell, std::uint32_t id) { ids_[next[cell]++] = id; });
}

}  // namespace kervan::sim
