// Every planner of OMPL that there is, many times: how long does it take beyond its deadline, on the clock? Every route
// that it gives has to be free.
#include <chrono>
#include <cstdio>
#include <cstring>
#include <random>

#include "components/planning/ompl_planner.hpp"
#include "components/planning/string_pulling.hpp"
#include "tests/planning/random_maps.hpp"

namespace {

using namespace kervan;
using namespace kervan::planning;

constexpr int side = 512;                 // cells
constexpr double deadline = 0.020;        // s
constexpr double allowed_beyond = 0.020;  // s

/// Rooms of 15 x 15 cells, with a door of one cell in most of their walls.
grid::Occupancy rooms(std::mt19937& random) {
  constexpr int room = 16;
  grid::Occupancy cells(1.0, -1, std::size_t{1} << 24);
  cells.cover({0, 0, side, side});
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) *cells.place({x, y}) = x % room == 0 || y % room == 0 ? 100 : 0;
  const auto door = [&] { return std::uniform_int_distribution(1, room - 1)(random); };
  for (int y = 0; y < side; y += room)
    for (int x = 0; x < side; x += room) {
      if (x > 0 && door() > 2) *cells.place({x, y + door()}) = 0;
      if (y > 0 && door() > 2) *cells.place({x + door(), y}) = 0;
    }
  return cells;
}

struct Tally {
  int runs = 0, solved = 0;
  double sum = 0.0, most = 0.0;  ///< s
  bool free = true;
};

void ask(OmplPlanner& planner, std::mt19937& random, Tally& tally) {
  const Costmap& map = planner.costmap();
  const auto any = [&] {
    const GridSearch::Cell cell = test::random_free_cell(random, map);
    return map.from_cells({cell.x + 0.5, cell.y + 0.5});
  };
  Query query;
  query.start = any();
  query.goal = any();
  Plan plan;
  const auto begin = std::chrono::steady_clock::now();
  planner.plan(query, plan);
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  ++tally.runs;
  tally.solved += plan.outcome == Outcome::found ? 1 : 0;
  tally.sum += took;
  tally.most = std::max(tally.most, took);
  for (std::size_t i = 1; i < plan.points.size(); ++i)
    tally.free =
        tally.free && std::isfinite(line_cost(map, map.to_cells(plan.points[i - 1]), map.to_cells(plan.points[i])));
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = argc == 2 && std::strcmp(argv[1], "--smoke") == 0;
  if (argc > 1 && !smoke) {
    std::fprintf(stderr, "usage: %s [--smoke]\n", argv[0]);
    return 2;
  }
  std::mt19937 random(1);
  std::vector<grid::Occupancy> maps;
  maps.push_back(rooms(random));
  maps.push_back(test::random_map(random, {0, 0, side, side}, 0.2));
  std::printf(
      "| planner | plane: solved | mean | longest | reeds_shepp: solved | mean | longest |\n"
      "|---|---|---|---|---|---|---|\n");
  bool good = true;
  for (std::size_t i = 0; i < ompl_names().size(); ++i) {
    std::printf("| %s |", ompl_names()[i].c_str());
    for (const OmplSpace space : {OmplSpace::plane, OmplSpace::reeds_shepp}) {
      Tally tally;
      for (grid::Occupancy& cells : maps) {
        OmplPlanner planner({.costs = {.radius = 0.0, .clearance = 0.0},
                             .algorithm = static_cast<OmplAlgorithm>(i),
                             .space = space,
                             .turning_radius = 3.0,
                             .deadline = deadline});
        planner.update(cells, {0, 0, side, side});
        const int runs = smoke ? 1 : space == OmplSpace::plane ? 100 : 20;
        for (int run = 0; run < runs; ++run) ask(planner, random, tally);
      }
      std::printf(" %d of %d | %.1f ms | %.1f ms |", tally.solved, tally.runs, 1e3 * tally.sum / tally.runs,
                  1e3 * tally.most);
      std::fflush(stdout);
      good = good && tally.free && (smoke || tally.most <= deadline + allowed_beyond);
    }
    std::printf("\n");
  }
  return good ? 0 : 1;
}
