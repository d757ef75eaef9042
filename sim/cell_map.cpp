#include "sim/cell_map.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace kervan::sim {

CellMap::CellMap(const Bitmap& bitmap)
    : corner_(bitmap.origin.position()),
      along_(geometry::heading(bitmap.origin.yaw)),
      upward_(-along_.y(), along_.x()),
      cell_(bitmap.cell),
      cells_(bitmap.columns, bitmap.rows, bitmap.solid),
      edges_(outer_edges(bitmap), {}) {}

CellMap::Place CellMap::place(const Vector2& at) const {
  const int column = std::clamp(static_cast<int>(at.x()), 0, cells_.columns() - 1);
  const int row = std::clamp(static_cast<int>(at.y()), 0, cells_.rows() - 1);
  return {column, row, static_cast<float>(std::clamp(at.x() - column, 0.0, 1.0)),
          static_cast<float>(std::clamp(at.y() - row, 0.0, 1.0))};
}

RayBatch CellMap::batch(double range) const {
  const auto number = [](double v) { return static_cast<float>(v); };
  RayBatch rays{};
  rays.skips = cells_.data();
  rays.columns = cells_.columns();
  rays.rows = cells_.rows();
  rays.xx = number(along_.x() / cell_.x());
  rays.xy = number(along_.y() / cell_.x());
  rays.yx = number(upward_.x() / cell_.y());
  rays.yy = number(upward_.y() / cell_.y());
  rays.range = number(range);
  return rays;
}

void CellMap::cast(std::span<const RayFan> fans, double range, std::span<float> distances,
                   std::span<std::int32_t> faces, Instructions instructions) const {
  assert(faces.size() == distances.size());
  std::array<std::int32_t, most_rays> columns, rows;
  std::array<float, most_rays> x, y, dx, dy;
  RayBatch rays = batch(range);
  rays.column = columns.data();
  rays.row = rows.data();
  rays.x = x.data();
  rays.y = y.data();
  rays.dx = dx.data();
  rays.dy = dy.data();
  std::size_t done = 0, waiting = 0;
  const auto cast_waiting = [&] {
    rays.count = static_cast<std::int32_t>(waiting);
    rays.distance = distances.data() + done;
    rays.face = faces.data() + done;
    sim::cast(rays, instructions);
    done += std::exchange(waiting, 0);
  };
  for (const RayFan& fan : fans) {
    const Vector2 at = in_cells(fan.origin);
    if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() <= cells_.columns() && at.y() <= cells_.rows())) {
      cast_waiting();
      for (const Vector2& direction : fan.directions) {
        cast_from_outside(at, direction, range, distances[done], faces[done]);
        ++done;
      }
      continue;
    }
    const Place from = place(at);
    for (std::size_t first = 0; first < fan.directions.size();) {
      if (waiting == most_rays) cast_waiting();
      const std::size_t count = std::min(most_rays - waiting, fan.directions.size() - first);
      for (std::size_t i = 0; i < count; ++i) {
        columns[waiting + i] = from.column;
        rows[waiting + i] = from.row;
        x[waiting + i] = from.x;
        y[waiting + i] = from.y;
        dx[waiting + i] = static_cast<float>(fan.directions[first + i].x());
        dy[waiting + i] = static_cast<float>(fan.directions[first + i].y());
      }
      first += count;
      waiting += count;
    }
  }
  cast_waiting();
  assert(done == distances.size());
}

void CellMap::cast_from_outside(const Vector2& at, const Vector2& ray, double range, float& distance,
                                std::int32_t& face) const {
  const float dx = static_cast<float>(ray.x()), dy = static_cast<float>(ray.y());
  const Vector2 direction(dx, dy);
  const Vector2 d(along_.dot(direction) / cell_.x(), upward_.dot(direction) / cell_.y());
  double enter = 0.0, leave = range;
  Face first = within_cell;
  const auto clip = [&](double position, double speed, int cells, Face border) {
    if (speed == 0.0) {
      if (position < 0.0 || position > cells) leave = -1.0;
      return;
    }
    const double low = -position / speed, high = (cells - position) / speed;
    if (std::min(low, high) > enter) {
      enter = std::min(low, high);
      first = border;
    }
    leave = std::min(leave, std::max(low, high));
  };
  clip(at.x(), d.x(), cells_.columns(), across_x);
  clip(at.y(), d.y(), cells_.rows(), across_y);
  distance = std::numeric_limits<float>::infinity();
  face = first;
  if (enter > leave) return;
  const Place from = place(at + enter * d);
  RayBatch one = batch(range - enter);
  one.column = &from.column;
  one.row = &from.row;
  one.x = &from.x;
  one.y = &from.y;
  one.dx = &dx;
  one.dy = &dy;
  one.count = 1;
  one.distance = &distance;
  one.face = &face;
  sim::cast(one, Instructions::scalar);
  if (face == within_cell) face = first;
  distance = static_cast<float>(distance + enter);
}

double CellMap::free_around(const Vector2& point) const {
  const Vector2 at = in_cells(point);
  if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < cells_.columns() && at.y() < cells_.rows())) return 0.0;
  // Of the first cell, the point's own, nothing counts: it may lie at its edge.
  const int cells = cells_.free_around(static_cast<int>(at.x()), static_cast<int>(at.y())) - 1;
  return std::max(0, cells) * cell_.minCoeff();
}

bool CellMap::solid_at(const Vector2& point) const {
  const Vector2 at = in_cells(point);
  if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < cells_.columns() && at.y() < cells_.rows())) return false;
  return cells_.blocked(static_cast<int>(at.x()), static_cast<int>(at.y()));
}

}  // namespace kervan::sim
