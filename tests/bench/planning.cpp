/// Grid planning beside a textbook A*, Theta* and planners of OMPL, in one run.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "components/planning/grid_planner.hpp"
#include "components/planning/ompl_planner.hpp"
#include "components/planning/string_pulling.hpp"
#include "framework/map_file/image.hpp"
#include "framework/map_file/map_file.hpp"
#include "tests/bench/maps.hpp"
#include "tests/bench/planning_reference.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/statistics.hpp"
#include "tests/planning/moving_ai.hpp"

namespace {

using namespace kervan;
using bench::Cell;
using bench::percentile;
using bench::say;
using planning::Costmap;
using planning::GridSearch;
using planning::Reached;
using planning::SearchRule;
using planning::StringPuller;

/// Of this thread, so that others on the machine do not count.
double cpu_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

template <class Work>
double time_of(const Work& work) {
  const double start = cpu_us();
  work();
  return cpu_us() - start;
}

struct Pair {
  Cell start, goal;
};

struct Place {
  std::string name;
  grid::CellBox box;
  grid::Occupancy cells;
};

/// Pairs of free cells that are connected.
std::vector<Pair> random_pairs(const Costmap& map, std::size_t count) {
  std::mt19937 random(1);
  GridSearch search;
  std::vector<Pair> pairs;
  const auto any = [&] {
    for (;;) {
      const Cell cell{std::uniform_int_distribution(1, map.columns())(random),
                      std::uniform_int_distribution(1, map.rows())(random)};
      if (!map.blocked(map.index(cell.x, cell.y))) return cell;
    }
  };
  while (pairs.size() < count) {
    const Pair pair{any(), any()};
    if (search.find(map, pair.start, pair.goal, SearchRule::canonical) == Reached::goal) pairs.push_back(pair);
  }
  return pairs;
}

/// Some of the queries of a map, evenly spread over their lengths.
std::vector<Pair> some_queries(const std::string& name, std::size_t count) {
  const std::vector<test::MovingAiQuery> all = test::moving_ai_queries(name);
  std::vector<Pair> pairs;
  const std::size_t step = std::max<std::size_t>(1, all.size() / count);
  for (std::size_t i = step - 1; i < all.size(); i += step) pairs.push_back({all[i].start, all[i].goal});
  return pairs;
}

/// us for each query: the least of several rounds, each of which asks all of them. Methods take turns.
std::vector<std::vector<double>> measure(const std::vector<std::function<void(const Pair&)>>& methods,
                                         const std::vector<Pair>& pairs, int rounds) {
  std::vector<std::vector<double>> best(methods.size(), std::vector<double>(pairs.size(), 1e18));
  for (int round = 0; round < rounds; ++round)
    for (std::size_t m = 0; m < methods.size(); ++m)
      for (std::size_t i = 0; i < pairs.size(); ++i)
        best[m][i] = std::min(best[m][i], time_of([&] { methods[m](pairs[i]); }));
  return best;
}

/// us of a query in the mean: the least of several rounds over all of them, timed as a whole, since reading the clock
/// takes as long as a short query. Methods take turns.
std::vector<double> measure_means(const std::vector<std::function<void(const Pair&)>>& methods,
                                  const std::vector<Pair>& pairs, int rounds) {
  std::vector<double> best(methods.size(), 1e18);
  for (int round = 0; round < rounds; ++round)
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const double all = time_of([&] {
        for (const Pair& pair : pairs) methods[m](pair);
      });
      best[m] = std::min(best[m], all / static_cast<double>(pairs.size()));
    }
  return best;
}

void bench_uniform(bool smoke) {
  say("\n## Uniform costs\n\nMaps and queries of movingai.com, up to 300 of a map, evenly spread; path included. In "
      "brackets: how many times\nfaster than the textbook's. Wanted: 4, 8, and 25 on rooms, cities and dao's maps "
      "(brc202d, orz900d, arena).\n\n"
      "| map | textbook A* | bucket A* | canonical | jump points |\n|---|---|---|---|---|\n");
  double logs[3] = {0.0, 0.0, 0.0};
  std::size_t maps = 0;
  for (const std::string& name : test::moving_ai_names()) {
    test::MovingAiMap file = test::moving_ai_map(name);
    const Costmap map = test::bare_costmap(file.cells, file.box);
    bench::TextbookSearch textbook;
    GridSearch search;
    const auto by = [&](SearchRule rule) {
      return [&search, &map, rule](const Pair& pair) { search.find(map, pair.start, pair.goal, rule); };
    };
    const auto times =
        measure_means({[&](const Pair& pair) { textbook.find(map, pair.start, pair.goal); },
                       by(SearchRule::all_neighbours), by(SearchRule::canonical), by(SearchRule::jump_point)},
                      some_queries(name, smoke ? 3 : 300), smoke ? 1 : 5);
    say("| %s | %.2f us |", name.c_str(), times[0]);
    for (std::size_t m = 1; m < times.size(); ++m) {
      const double ratio = times[0] / times[m];
      logs[m - 1] += std::log(ratio);
      say(" %.2f us (%.1f) |", times[m], ratio);
    }
    say("\n");
    ++maps;
  }
  say("| geometric mean | |");
  for (const double sum : logs) say(" (%.1f) |", std::exp(sum / static_cast<double>(std::max<std::size_t>(1, maps))));
  say("\n");
}

void bench_any_angle(bool smoke) {
  say("\n## Any angle\n\nThe same maps; canonical A*, then pulled taut. Length as a part of Theta*'s, mean and worst "
      "of 60 queries; wanted: 1.01.\n\n| map | length | worst | way on the grid | search | pulling | Theta* |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const std::string& name : test::moving_ai_names()) {
    test::MovingAiMap file = test::moving_ai_map(name);
    const Costmap map = test::bare_costmap(file.cells, file.box);
    GridSearch search;
    StringPuller string;
    bench::ThetaStar theta;
    std::vector<double> ratios, on_grid, searching, pulling, reference;
    for (const Pair& pair : some_queries(name, smoke ? 2 : 60)) {
      std::optional<double> wanted;
      reference.push_back(time_of([&] { wanted = theta.find(map, pair.start, pair.goal); }));
      searching.push_back(time_of([&] { search.find(map, pair.start, pair.goal, SearchRule::canonical); }));
      double length = 0.0;
      pulling.push_back(time_of([&] {
        const auto& points = string.pull(map, search.path(), middle_of(pair.start), middle_of(pair.goal));
        for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
      }));
      if (!wanted || *wanted < 1.0) continue;
      ratios.push_back(length / *wanted);
      on_grid.push_back(search.cost() / *wanted);
    }
    say("| %s | %.4f | %.4f | %.4f | %.1f us | %.1f us | %.0f us |\n", name.c_str(), mean(ratios),
        percentile(ratios, 1.0), mean(on_grid), mean(searching), mean(pulling), mean(reference));
  }
}

/// A picture of Stage as a map, dark pixels occupied, each of them `times` cells wide and high.
Place stage(const std::string& file, const std::string& name, double resolution, int times) {
  const map_file::Image image = map_file::load_image(*bench::test_data("stage/" + file));
  Place place{name, {0, 0, image.columns * times, image.rows * times}, {resolution, -1, std::size_t{1} << 30}};
  place.cells.cover(place.box);
  for (int y = 0; y < place.box.rows; ++y)
    for (int x = 0; x < place.box.columns; ++x)
      *place.cells.place({x, y}) =
          image.pixels[static_cast<std::size_t>((image.rows - 1 - y / times) * image.columns + x / times)].shade < 128
              ? 100
              : 0;
  return place;
}

Place moving_ai(const std::string& name, int times) {
  const test::MovingAiMap map = test::moving_ai_map(name);
  Place place{name + (times > 1 ? ", cells " + std::to_string(times) + " times as many" : ""),
              {0, 0, map.box.columns * times, map.box.rows * times},
              {0.05, -1, std::size_t{1} << 30}};
  place.cells.cover(place.box);
  for (int y = 0; y < place.box.rows; ++y)
    for (int x = 0; x < place.box.columns; ++x) *place.cells.place({x, y}) = map.cells.at({x / times, y / times});
  return place;
}

Place of_ros(const std::string& name) {
  const map_file::GridMap file = map_file::load(*bench::test_data("ros/" + name + ".yaml"));
  return {name, grid::cells_of(file), grid::from_map_file(file, std::size_t{1} << 30)};
}

void bench_weighted(bool smoke) {
  say("\n## Clearance costs\n\nCells of 5 cm, a robot of 0.25 m radius, 0.3 m of clearance at up to 4 times the cost "
      "(the component's defaults); the\nunknown is an obstacle. Random pairs; the whole plan with its straightening. "
      "Wanted: "
      "500 x 500 p99 under 2 ms, 1024 x 1024\nnever over 15 ms. Update: of the whole costmap, and of the part that one "
      "changed tile "
      "is felt in.\n\n| map | cells | free | mean | p99 | most | all neighbours | update | of one tile |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  if (!bench::test_data("stage/cave.png")) return;
  std::vector<std::function<Place()>> places = {
      [] { return stage("cave.png", "Stage's cave", 0.05, 1); },
      [] { return of_ros("tb3_sandbox"); },
      [] { return moving_ai("brc202d", 1); },
      [] { return of_ros("willow-full-0.05"); },
      [] { return stage("cave.png", "Stage's cave", 0.05, 2); },
      [] { return stage("hospital_section.png", "Stage's hospital", 0.05, 1); },
      [] { return moving_ai("maze512-8-0", 2); },
      [] { return moving_ai("Berlin_1_256", 4); }};
  if (smoke) places.resize(1);
  for (const auto& make : places) {
    Place place = make();
    Costmap map({.unknown_is_free = false});
    const double update = time_of([&] { map.update(place.cells, place.box); });
    place.cells.touch({place.box.x + place.box.columns / 2, place.box.y + place.box.rows / 2, 1, 1});
    const double one_tile = time_of([&] { map.update(place.cells, place.box); });
    std::size_t free = 0;
    for (std::uint32_t cell = 0; cell < map.cells(); ++cell) free += map.blocked(cell) ? 0 : 1;
    GridSearch search;
    StringPuller string;
    const auto times =
        measure({[&](const Pair& pair) {
                   search.find(map, pair.start, pair.goal, SearchRule::canonical);
                   string.pull(map, search.path(), middle_of(pair.start), middle_of(pair.goal));
                 },
                 [&](const Pair& pair) { search.find(map, pair.start, pair.goal, SearchRule::all_neighbours); }},
                random_pairs(map, smoke ? 3 : 300), smoke ? 1 : 3);
    say("| %s | %d x %d | %zu | %.2f ms | %.2f ms | %.2f ms | %.2f ms | %.1f ms | %.2f ms |\n", place.name.c_str(),
        place.box.columns, place.box.rows, free, 1e-3 * mean(times[0]), 1e-3 * percentile(times[0], 0.99),
        1e-3 * percentile(times[0], 1.0), 1e-3 * mean(times[1]), 1e-3 * update, 1e-3 * one_tile);
  }
}

/// Length and time of one planner's answers, beside those of A* pulled taut.
struct Answers {
  std::vector<double> lengths, times;  ///< parts of the shortest on the grid; us
};

void bench_ompl(bool smoke) {
  const double limit = smoke ? 0.01 : 0.1;
  say("\n## OMPL\n\n%.0f ms for each of 8 queries, as planning/ompl plans: motions tested exactly, exact solutions "
      "only, "
      "made shorter in what is\nleft of the time. Length as a part of the shortest way on the grid; canonical A* "
      "pulled taut "
      "beside it.\n\n"
      "| map | planner | solved | length | mean time | beside A* |\n|---|---|---|---|---|---|\n",
      1e3 * limit);
  if (test::moving_ai_names().empty()) return;
  for (const std::string name : {"arena", "brc202d", "16room_000", "random512-20-0", "Berlin_1_256"}) {
    test::MovingAiMap file = test::moving_ai_map(name);
    const Costmap map = test::bare_costmap(file.cells, file.box);
    const std::vector<Pair> pairs = some_queries(name, smoke ? 1 : 8);
    double of_astar = 0.0;
    const auto tell = [&](const std::string& planner, const Answers& answers) {
      const double time = mean(answers.times);
      if (of_astar == 0.0) of_astar = time;
      say("| %s | %s | %zu of %zu |", name.c_str(), planner.c_str(), answers.lengths.size(), pairs.size());
      answers.lengths.empty() ? say(" - |") : say(" %.3f |", mean(answers.lengths));
      say(" %.2f ms | %.0f |\n", 1e-3 * time, time / of_astar);
    };
    const auto ask = [&](planning::MapPlanner& planner) {
      planner.update(file.cells, file.box);
      GridSearch search;
      planning::Plan plan;
      Answers answers;
      for (const Pair& pair : pairs) {
        search.find(map, pair.start, pair.goal, SearchRule::jump_point);
        const planning::Query query{.start = map.from_cells(middle_of(pair.start)),
                                    .goal = map.from_cells(middle_of(pair.goal))};
        answers.times.push_back(time_of([&] { planner.plan(query, plan); }));
        if (plan.outcome == planning::Outcome::found && search.cost() > 0.0)
          answers.lengths.push_back(plan.length / (search.cost() * map.resolution()));
      }
      return answers;
    };
    planning::GridPlanner astar({.costs = map.params(), .search = planning::SearchChoice::canonical});
    tell("A*", ask(astar));
    for (const auto algorithm : {planning::OmplAlgorithm::prm_star, planning::OmplAlgorithm::rrt_connect}) {
      planning::OmplPlanner planner({.costs = map.params(), .algorithm = algorithm, .deadline = limit});
      tell(planning::ompl_names()[static_cast<std::size_t>(algorithm)], ask(planner));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = bench::begin(argc, argv, "Grid planning");
  say("\nOne thread, its CPU time; the least of three rounds for each query, methods in turns; with uniform "
      "costs of\nfive rounds over all queries.\n");
  if (test::moving_ai_names().empty()) say("\nWithout test data (KERVAN_TEST_DATA) there is nothing to measure.\n");
  bench_uniform(smoke);
  bench_any_angle(smoke);
  bench_weighted(smoke);
  bench_ompl(smoke);
  return bench::end();
}
