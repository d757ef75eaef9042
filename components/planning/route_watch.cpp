#include "components/planning/route_watch.hpp"

#include <cstddef>

#include "components/planning/line_walk.hpp"

namespace kervan::planning {

std::uint8_t RouteWatch::weight_at(const Costmap& map, const grid::Cell& cell) {
  const int x = cell.x - map.box().x + 1, y = cell.y - map.box().y + 1;
  return map.contains(x, y) ? map.weight(map.index(x, y)) : Costmap::occupied;
}

void RouteWatch::watch(const Costmap& map, const std::vector<geometry::Vector2>& points) {
  cells_.clear();
  double along = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const geometry::Vector2 from = map.to_cells(points[i - 1]), to = map.to_cells(points[i]);
    const double length = (points[i] - points[i - 1]).norm();
    walk_line(from, to, [&](int x, int y, double share) {
      along += share * length;
      const grid::Cell cell{x + map.box().x - 1, y + map.box().y - 1};
      cells_.push_back({cell, along, share * length, weight_at(map, cell)});
      return true;
    });
  }
}

RouteChange RouteWatch::look(const Costmap& map, double along, double tolerated) const {
  double before = 0.0, now = 0.0;
  for (const Passed& passed : cells_) {
    if (passed.along <= along || passed.weight < Costmap::lightest) continue;
    const std::uint8_t weight = weight_at(map, passed.cell);
    if (weight < Costmap::lightest) return RouteChange::blocked;
    before += passed.weight * passed.length;
    now += weight * passed.length;
  }
  return now > before * (1.0 + tolerated) ? RouteChange::dearer : RouteChange::none;
}

}  // namespace kervan::planning
