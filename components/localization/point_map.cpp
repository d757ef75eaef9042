#include "components/localization/point_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "components/mapping/cell_walk.hpp"

namespace kervan::localization {
namespace {

const grid::LogOdds hit = grid::log_odds_of(0.65), miss = grid::log_odds_of(0.45);

/// m; what is no farther from a cell along either axis belongs to the same surface.
constexpr double patch = 0.15;

}  // namespace

bool PointMap::add(const geometry::Vector2& sensor, const geometry::Vector2& point) {
  if (!grid::has_cell(sensor) || !grid::has_cell(point)) return false;
  const grid::Cell first = grid::cell_of(sensor, resolution()), last = grid::cell_of(point, resolution());
  const geometry::Vector2 way(last.x - first.x, last.y - first.y);
  const double length = way.norm();
  if (cells_.cover(grid::united({first.x, first.y, 1, 1}, {last.x, last.y, 1, 1})) == grid::Growth::refused)
    return false;
  const geometry::Vector2 direction = length > 0.0 ? geometry::Vector2(way / length) : geometry::Vector2::UnitX();
  const auto pass = [](PointCell& cell) { cell.log_odds = grid::added(cell.log_odds, miss); };
  PointCell& cell = *mapping::CellWalk(first, direction, length).over(cells_.place(first), cells_.stride(), pass);
  cell.log_odds = grid::added(cell.log_odds, hit);
  cell.echoes = std::min<std::uint16_t>(static_cast<std::uint16_t>(cell.echoes + 1), PointCell::most_echoes);
  const geometry::Vector2 off = (point - grid::center_of(last, resolution())) / resolution();
  cell.x += (static_cast<float>(off.x()) - cell.x) / static_cast<float>(cell.echoes);
  cell.y += (static_cast<float>(off.y()) - cell.y) / static_cast<float>(cell.echoes);
  return true;
}

std::optional<geometry::Vector2> PointMap::echo(const grid::Cell& cell) const {
  const PointCell& found = at(cell);
  if (found.log_odds <= 0 || found.echoes == 0) return std::nullopt;
  return geometry::Vector2(cell.x + 0.5 + static_cast<double>(found.x), cell.y + 0.5 + static_cast<double>(found.y));
}

std::optional<Surface> PointMap::surface(const geometry::Vector2& at, double reach) const {
  if (!grid::has_cell(at)) return std::nullopt;
  using geometry::Vector2;
  const grid::Cell here = grid::cell_of(at, resolution());
  const Vector2 place = at / resolution();
  const int far = static_cast<int>(std::ceil(reach / resolution()));
  std::optional<grid::Cell> nearest;
  double least = reach * reach / (resolution() * resolution());
  for (int y = here.y - far; y <= here.y + far; ++y)
    for (int x = here.x - far; x <= here.x + far; ++x)
      if (const auto point = echo({x, y}); point && (*point - place).squaredNorm() < least) {
        least = (*point - place).squaredNorm();
        nearest = grid::Cell{x, y};
      }
  if (!nearest) return std::nullopt;
  const int around = static_cast<int>(std::lround(patch / resolution()));
  Vector2 mean = Vector2::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  int count = 0;
  for (int y = nearest->y - around; y <= nearest->y + around; ++y)
    for (int x = nearest->x - around; x <= nearest->x + around; ++x)
      if (const auto point = echo({x, y})) {
        const Vector2 off = *point - place;
        mean += off;
        squares += off * off.transpose();
        ++count;
      }
  mean /= count;
  const Eigen::Matrix2d spread = squares / count - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(spread);
  const Vector2 variances = axes.eigenvalues().cwiseMax(0.0);
  if (count < 3 || variances[0] > 0.2 * variances[1]) return std::nullopt;
  return Surface{(place + mean) * resolution(), axes.eigenvectors().col(0), std::sqrt(variances[0]) * resolution()};
}

}  // namespace kervan::localization
