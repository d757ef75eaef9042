/// Random maps, and a search for them that is too simple to be wrong.
#pragma once

#include <cstdint>
#include <optional>
#include <random>

#include "components/planning/costmap.hpp"
#include "components/planning/grid_search.hpp"

namespace kervan::test {

/// `share` of the cells of a box that begins at (x, y) are occupied.
grid::Occupancy random_map(std::mt19937& random, const grid::CellBox& box, double share, double resolution = 1.0);

/// A cell that is not blocked; there must be one.
planning::GridSearch::Cell random_free_cell(std::mt19937& random, const planning::Costmap& map);

/// Dijkstra's algorithm on nothing but the weights of the cells. In units of GridSearch; nothing if there is no way.
std::optional<std::uint64_t> dijkstra(const planning::Costmap& map, planning::GridSearch::Cell start,
                                      planning::GridSearch::Cell goal);

/// What the steps of a path cost, by the weights alone; nothing if one of them is not allowed.
std::optional<std::uint64_t> cost_of_steps(const planning::Costmap& map,
                                           const std::vector<planning::GridSearch::Cell>& path);

}  // namespace kervan::test
