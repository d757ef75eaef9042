#include "tests/planning/moving_ai.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace kervan::test {
namespace {

namespace fs = std::filesystem;

fs::path find(const fs::path& below, const std::string& begin, const std::string& end) {
  for (const auto& entry : fs::recursive_directory_iterator(below)) {
    const std::string file = entry.path().filename();
    if (file.starts_with(begin) && file.ends_with(end)) return entry.path();
  }
  throw std::runtime_error("no file " + begin + "…" + end + " below " + below.string());
}

fs::path folder() { return fs::path(test_data_folder()) / "movingai"; }

}  // namespace

std::string test_data_folder() {
  const char* given = std::getenv("KERVAN_TEST_DATA");
  return given ? given : KERVAN_SOURCES "/../shared/data";
}

std::vector<std::string> moving_ai_names() {
  std::vector<std::string> names;
  if (!fs::exists(folder())) return names;
  for (const auto& entry : fs::recursive_directory_iterator(folder() / "maps"))
    if (entry.path().extension() == ".map") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

MovingAiMap moving_ai_map(const std::string& name) {
  std::ifstream file(find(folder() / "maps", name + ".map", ".map"));
  std::string word, row;
  MovingAiMap map;
  map.name = name;
  file >> word >> word >> word >> map.box.rows >> word >> map.box.columns >> word;
  map.cells.cover(map.box);
  for (int y = 0; y < map.box.rows; ++y) {
    file >> row;
    if (row.size() != static_cast<std::size_t>(map.box.columns))
      throw std::runtime_error(name + ": a row of the map has another length");
    for (int x = 0; x < map.box.columns; ++x) {
      const char c = row[static_cast<std::size_t>(x)];
      *map.cells.place({x, y}) = c == '.' || c == 'G' || c == 'S' ? 0 : 100;
    }
  }
  return map;
}

std::vector<MovingAiQuery> moving_ai_queries(const std::string& name) {
  std::ifstream file(find(folder() / "scenarios", name, ".scen"));
  std::string word;
  file >> word >> word;
  std::vector<MovingAiQuery> queries;
  MovingAiQuery q;
  int bucket = 0, columns = 0, rows = 0;
  while (file >> bucket >> word >> columns >> rows >> q.start.x >> q.start.y >> q.goal.x >> q.goal.y >> q.length) {
    for (planning::GridSearch::Cell* cell : {&q.start, &q.goal}) *cell = {cell->x + 1, cell->y + 1};
    queries.push_back(q);
  }
  return queries;
}

grid::CellBox drawn_box(const std::vector<std::string>& lines) {
  return {0, 0, static_cast<int>(lines.front().size()), static_cast<int>(lines.size())};
}

grid::Occupancy drawn_map(const std::vector<std::string>& lines, double resolution) {
  grid::Occupancy cells(resolution, -1, std::size_t{1} << 30);
  const grid::CellBox box = drawn_box(lines);
  cells.cover(box);
  for (int y = 0; y < box.rows; ++y)
    for (int x = 0; x < box.columns; ++x)
      *cells.place({x, box.rows - 1 - y}) =
          lines[static_cast<std::size_t>(y)].at(static_cast<std::size_t>(x)) == '#' ? 100 : 0;
  return cells;
}

planning::Costmap bare_costmap(grid::Occupancy& cells, const grid::CellBox& box) {
  planning::Costmap map({.radius = 0.0, .clearance = 0.0, .clearance_cost = 0.0});
  map.update(cells, box);
  return map;
}

}  // namespace kervan::test
