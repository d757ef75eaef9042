#include "sim/cell_map.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace kervan::sim {

CellMap::CellMap(const Bitmap& bitmap)
    : corner_(bitmap.origin.position()),
      along_(geometry::heading(bitmap.origin.yaw)),
      upward_(-along_.y(), along_.x()),
      cell_(bitmap.cell),
      cells_(bitmap.columns, bitmap.rows, bitmap.solid),
      edges_(outer_edges(bitmap), {}) {}

Vector2 CellMap::in_cells(const Vector2& point) const {
  const Vector2 offset = point - corner_;
  return {along_.dot(offset) / cell_.x(), upward_.dot(offset) / cell_.y()};
}

RayFan CellMap::fan(const Vector2& origin, double range) const {
  const int column = std::clamp(static_cast<int>(std::floor(origin.x())), 0, cells_.columns() - 1);
  const int row = std::clamp(static_cast<int>(std::floor(origin.y())), 0, cells_.rows() - 1);
  const auto number = [](double v) { return static_cast<float>(v); };
  return {.skips = cells_.data(),
          .columns = cells_.columns(),
          .rows = cells_.rows(),
          .xx = number(along_.x() / cell_.x()),
          .xy = number(along_.y() / cell_.x()),
          .yx = number(upward_.x() / cell_.y()),
          .yy = number(upward_.y() / cell_.y()),
          .column = column,
          .row = row,
          .x = number(std::clamp(origin.x() - column, 0.0, 1.0)),
          .y = number(std::clamp(origin.y() - row, 0.0, 1.0)),
          .range = number(range),
          .dx = nullptr,
          .dy = nullptr,
          .count = 0,
          .distance = nullptr,
          .face = nullptr};
}

void CellMap::cast(const Vector2& origin, std::span<const float> dx, std::span<const float> dy, double range,
                   std::span<float> distances, std::span<std::int32_t> faces, Instructions instructions) const {
  assert(dy.size() == dx.size() && distances.size() == dx.size() && faces.size() == dx.size());
  const Vector2 at = in_cells(origin);
  const bool inside = at.x() >= 0.0 && at.y() >= 0.0 && at.x() <= cells_.columns() && at.y() <= cells_.rows();
  RayFan rays = inside ? fan(at, range) : fan(Vector2::Zero(), range);
  rays.dx = dx.data();
  rays.dy = dy.data();
  rays.count = static_cast<std::int32_t>(dx.size());
  rays.distance = distances.data();
  rays.face = faces.data();
  if (inside)
    sim::cast(rays, instructions);
  else
    cast_from_outside(at, rays, range, instructions);
}

void CellMap::cast_from_outside(const Vector2& at, RayFan rays, double range, Instructions instructions) const {
  const std::int32_t count = rays.count;
  rays.count = 1;
  for (std::int32_t i = 0; i < count; ++i, ++rays.dx, ++rays.dy, ++rays.distance, ++rays.face) {
    const Vector2 direction(*rays.dx, *rays.dy);
    const Vector2 d(along_.dot(direction) / cell_.x(), upward_.dot(direction) / cell_.y());
    double enter = 0.0, leave = range;
    Face first = within_cell;
    const auto clip = [&](double position, double speed, int cells, Face face) {
      if (speed == 0.0) {
        if (position < 0.0 || position > cells) leave = -1.0;
        return;
      }
      const double low = -position / speed, high = (cells - position) / speed;
      if (std::min(low, high) > enter) {
        enter = std::min(low, high);
        first = face;
      }
      leave = std::min(leave, std::max(low, high));
    };
    clip(at.x(), d.x(), cells_.columns(), across_x);
    clip(at.y(), d.y(), cells_.rows(), across_y);
    *rays.distance = std::numeric_limits<float>::infinity();
    *rays.face = first;
    if (enter > leave) continue;
    RayFan one = fan(at + enter * d, range - enter);
    one.dx = rays.dx;
    one.dy = rays.dy;
    one.count = 1;
    one.distance = rays.distance;
    one.face = rays.face;
    sim::cast(one, instructions);
    if (*one.face == within_cell) *one.face = first;
    *one.distance = static_cast<float>(*one.distance + enter);
  }
}

Vector2 CellMap::normal(const Vector2& direction, std::int32_t face) const {
  if (face == within_cell) return -direction;
  const Vector2& axis = face == across_x ? along_ : upward_;
  return direction.dot(axis) > 0.0 ? Vector2(-axis) : axis;
}

bool CellMap::solid_at(const Vector2& point) const {
  const Vector2 at = in_cells(point);
  if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < cells_.columns() && at.y() < cells_.rows())) return false;
  return cells_.blocked(static_cast<int>(at.x()), static_cast<int>(at.y()));
}

}  // namespace kervan::sim
