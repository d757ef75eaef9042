/// Maps and queries in the formats of movingai.com (Sturtevant 2012, "Benchmarks for Grid-Based Pathfinding",
/// doi:10.1109/TCIAIG.2012.2197681), for tests and benchmarks of the grid planner.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "components/grid/occupancy.hpp"
#include "components/planning/costmap.hpp"
#include "components/planning/grid_search.hpp"

namespace kervan::test {

/// The folder that KERVAN_TEST_DATA names, else ../shared/data beside the project.
std::string test_data_folder();

/// Cells of 1 m, of which free ones have 0 per cent and all others 100. The first row of the file is the lowest one:
/// that only turns the map over.
struct MovingAiMap {
  std::string name;  ///< "brc202d"
  grid::CellBox box;
  grid::Occupancy cells{1.0, -1, std::size_t{1} << 30};
};

struct MovingAiQuery {
  planning::GridSearch::Cell start, goal;  ///< counted from 1
  double length = 0.0;                     ///< of the shortest way, in cells
};

/// The names of all maps that have queries, in order; none if the folder is not there.
std::vector<std::string> moving_ai_names();

/// Throws std::runtime_error if the file cannot be read.
MovingAiMap moving_ai_map(const std::string& name);
std::vector<MovingAiQuery> moving_ai_queries(const std::string& name);

/// A map drawn with '#' for obstacles and anything else for free cells; the first line is the top.
grid::Occupancy drawn_map(const std::vector<std::string>& lines, double resolution = 1.0);
grid::CellBox drawn_box(const std::vector<std::string>& lines);

/// A costmap on which only the obstacles themselves are blocked.
planning::Costmap bare_costmap(grid::Occupancy& cells, const grid::CellBox& box);

}  // namespace kervan::test
