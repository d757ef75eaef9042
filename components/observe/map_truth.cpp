#include "components/observe/map_truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace kervan::observe {
namespace {

using geometry::Vector2;
using grid::Cell;
using grid::CellBox;

constexpr double margin = 0.1;  // of a cell
constexpr std::size_t most_bytes = std::size_t{1} << 30;

/// Part of the line from a to b, as shares from 0 to 1, that lies between `low` and `high` along one axis; false if
/// none does.
bool clip(double a, double along, double low, double high, double& from, double& to) {
  if (along == 0.0) return a >= low && a <= high;
  const double first = (low - a) / along, second = (high - a) / along;
  from = std::max(from, std::min(first, second));
  to = std::min(to, std::max(first, second));
  return from <= to;
}

double distance_to(const Vector2& point, const Vector2& a, const Vector2& b) {
  const Vector2 along = b - a;
  const double length = along.squaredNorm();
  const double share = length > 0.0 ? std::clamp((point - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return (point - (a + share * along)).norm();
}

}  // namespace

MapTruth::MapTruth(const DrawnWorld& world, std::span<const Vector2> seeds, double resolution)
    : circles_(world.circles), cells_(resolution, TrueCell::hidden, most_bytes) {
  for (const auto& [a, b] : world.walls) edges_.push_back({a, b});
  for (const Polyline& polygon : world.polygons)
    for (std::size_t i = 0; i < polygon.size(); ++i)
      edges_.push_back({polygon[i], polygon[i + 1 == polygon.size() ? 0 : i + 1]});
  std::erase_if(edges_, [](const Edge& edge) { return !grid::has_cell(edge.a) || !grid::has_cell(edge.b); });
  std::erase_if(circles_,
                [](const DrawnCircle& c) { return !grid::has_cell(c.center) || !(c.radius >= 0.0 && c.radius < 1e5); });

  CellBox box;
  const auto include = [&](const Vector2& point) {
    if (!grid::has_cell(point)) return;
    const Cell cell = grid::cell_of(point, resolution);
    box = grid::united(box, {cell.x - 2, cell.y - 2, 5, 5});
  };
  for (const Edge& edge : edges_) {
    include(edge.a);
    include(edge.b);
  }
  for (const DrawnCircle& circle : circles_) {
    include(circle.center - Vector2::Constant(circle.radius));
    include(circle.center + Vector2::Constant(circle.radius));
  }
  for (const Vector2& seed : seeds) include(seed);
  if (cells_.cover(box) == grid::Growth::refused)
    throw std::invalid_argument("the world is too large to be compared with a map of these cells");
  for (const Edge& edge : edges_) mark(edge);
  for (const DrawnCircle& circle : circles_) {
    // A chord of a circle leaves it by less than a hundredth of a cell.
    const double radius = std::max(circle.radius, resolution);
    const int corners = std::max(16, static_cast<int>(std::ceil(7.0 * std::sqrt(radius / (0.01 * resolution)))));
    const auto corner = [&](int i) {
      return Vector2(circle.center + circle.radius * geometry::heading(2.0 * std::numbers::pi * i / corners));
    };
    for (int i = 0; i < corners; ++i) mark({corner(i), corner(i + 1)});
  }
  flood(seeds);
}

/// The cells that an edge passes through or along, row by row.
void MapTruth::mark(const Edge& edge) {
  const double resolution = cells_.resolution();
  const Vector2 a = edge.a / resolution, along = (edge.b - edge.a) / resolution;
  const double low = std::min(a.y(), a.y() + along.y()), high = std::max(a.y(), a.y() + along.y());
  const auto passes = [&](int x, int y, double inset) {
    double from = 0.0, to = 1.0;
    return clip(a.x(), along.x(), x + inset, x + 1.0 - inset, from, to) &&
           clip(a.y(), along.y(), y + inset, y + 1.0 - inset, from, to);
  };
  for (int row = static_cast<int>(std::floor(low - margin)); row <= static_cast<int>(std::floor(high + margin));
       ++row) {
    double from = 0.0, to = 1.0;
    if (!clip(a.y(), along.y(), row - margin, row + 1.0 + margin, from, to)) continue;
    const double x0 = a.x() + from * along.x(), x1 = a.x() + to * along.x();
    const int first = static_cast<int>(std::floor(std::min(x0, x1) - margin));
    const int last = static_cast<int>(std::floor(std::max(x0, x1) + margin));
    for (int x = first; x <= last; ++x) {
      TrueCell& cell = *cells_.place({x, row});
      if (passes(x, row, margin))
        cell = TrueCell::occupied;
      else if (cell != TrueCell::occupied && passes(x, row, -margin))
        cell = TrueCell::border;
    }
  }
}

void MapTruth::flood(std::span<const Vector2> seeds) {
  std::vector<Cell> open;
  const auto enter = [&](const Cell& cell) {
    if (!cells_.box().contains(cell) || cells_.at(cell) != TrueCell::hidden) return;
    *cells_.place(cell) = TrueCell::free;
    open.push_back(cell);
  };
  for (const Vector2& seed : seeds)
    if (grid::has_cell(seed)) enter(grid::cell_of(seed, cells_.resolution()));
  while (!open.empty()) {
    const Cell cell = open.back();
    open.pop_back();
    enter({cell.x + 1, cell.y});
    enter({cell.x - 1, cell.y});
    enter({cell.x, cell.y + 1});
    enter({cell.x, cell.y - 1});
  }
}

double MapTruth::distance(const Vector2& point) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Edge& edge : edges_) nearest = std::min(nearest, distance_to(point, edge.a, edge.b));
  for (const DrawnCircle& circle : circles_)
    nearest = std::min(nearest, std::abs((point - circle.center).norm() - circle.radius));
  return nearest;
}

}  // namespace kervan::observe
