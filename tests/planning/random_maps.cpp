#include "tests/planning/random_maps.hpp"

#include <cstdlib>
#include <queue>
#include <tuple>

namespace kervan::test {
namespace {

using planning::Costmap;
using planning::GridSearch;

/// From a cell to one beside it.
std::optional<std::uint64_t> cost_of_step(const Costmap& map, int x, int y, int to_x, int to_y) {
  const auto free = [&](int column, int row) { return map.weight(map.index(column, row)) >= Costmap::lightest; };
  if (!free(to_x, to_y)) return std::nullopt;
  if (x != to_x && y != to_y && !(free(x, to_y) && free(to_x, y))) return std::nullopt;
  return (x != to_x && y != to_y ? 8119u : 5741u) * std::uint64_t{map.weight(map.index(to_x, to_y))};
}

}  // namespace

grid::Occupancy random_map(std::mt19937& random, const grid::CellBox& box, double share, double resolution) {
  grid::Occupancy map(resolution, -1, std::size_t{1} << 30);
  map.cover(box);
  for (int y = box.y; y < box.y + box.rows; ++y)
    for (int x = box.x; x < box.x + box.columns; ++x)
      *map.place({x, y}) = std::uniform_real_distribution(0.0, 1.0)(random) < share ? 100 : 0;
  map.touch(box);
  return map;
}

GridSearch::Cell random_free_cell(std::mt19937& random, const Costmap& map) {
  for (;;) {
    const GridSearch::Cell cell{std::uniform_int_distribution(1, map.columns())(random),
                                std::uniform_int_distribution(1, map.rows())(random)};
    if (!map.blocked(map.index(cell.x, cell.y))) return cell;
  }
}

std::optional<std::uint64_t> dijkstra(const Costmap& map, GridSearch::Cell start, GridSearch::Cell goal) {
  using Open = std::tuple<std::uint64_t, int, int>;
  std::vector<bool> closed(map.cells());
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  open.push({0, start.x, start.y});
  while (!open.empty()) {
    const auto [cost, x, y] = open.top();
    open.pop();
    if (closed[map.index(x, y)]) continue;
    closed[map.index(x, y)] = true;
    if (x == goal.x && y == goal.y) return cost;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (const auto step = cost_of_step(map, x, y, x + dx, y + dy); step && (dx != 0 || dy != 0))
          open.push({cost + *step, x + dx, y + dy});
  }
  return std::nullopt;
}

std::optional<std::uint64_t> cost_of_steps(const Costmap& map, const std::vector<GridSearch::Cell>& path) {
  std::uint64_t cost = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const int dx = path[i].x - path[i - 1].x, dy = path[i].y - path[i - 1].y;
    if (std::abs(dx) > 1 || std::abs(dy) > 1 || (dx == 0 && dy == 0)) return std::nullopt;
    const auto step = cost_of_step(map, path[i - 1].x, path[i - 1].y, path[i].x, path[i].y);
    if (!step) return std::nullopt;
    cost += *step;
  }
  return cost;
}

}  // namespace kervan::test
