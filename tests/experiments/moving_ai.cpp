// Every query of the maps of movingai.com, by every rule of the grid search: each way has to be as short as it can be.
#include "tests/planning/moving_ai.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>

#include "components/planning/string_pulling.hpp"

namespace {

using namespace kervan;
using planning::Costmap;
using planning::GridSearch;
using planning::Reached;
using planning::SearchRule;

/// The files print five or eight digits behind the point, of sums of their own rounding.
constexpr double tolerance = 1e-5;

struct Tally {
  std::size_t queries = 0;
  std::size_t wrong = 0;    ///< no way, or one of another length
  double most_off = 0.0;    ///< part of the length
  std::size_t touched = 0;  ///< pulled lines through something blocked
  double pulled = 0.0;      ///< sum of the pulled lengths as parts of those on the grid
};

void ask(const Costmap& map, const test::MovingAiQuery& query, GridSearch& search, planning::StringPuller& string,
         Tally& tally) {
  ++tally.queries;
  bool wrong = false;
  for (const SearchRule rule : {SearchRule::all_neighbours, SearchRule::canonical, SearchRule::jump_point}) {
    if (search.find(map, query.start, query.goal, rule) != Reached::goal) {
      wrong = true;
      continue;
    }
    const double off = std::abs(search.cost() - query.length) / (1.0 + query.length);
    tally.most_off = std::max(tally.most_off, off);
    wrong = wrong || off > tolerance;
  }
  tally.wrong += wrong ? 1 : 0;
  if (wrong || query.length == 0.0) return void(tally.pulled += 1.0);
  const auto middle = [](const GridSearch::Cell& cell) { return geometry::Vector2(cell.x + 0.5, cell.y + 0.5); };
  const auto& points = string.pull(map, search.path(), middle(query.start), middle(query.goal));
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    length += (points[i] - points[i - 1]).norm();
    tally.touched += std::isfinite(planning::line_cost(map, points[i - 1], points[i])) ? 0 : 1;
  }
  tally.pulled += length / search.cost();
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = argc == 2 && std::strcmp(argv[1], "--smoke") == 0;
  if (argc > 1 && !smoke) {
    std::fprintf(stderr, "usage: %s [--smoke]\n", argv[0]);
    return 2;
  }
  const std::vector<std::string> names = test::moving_ai_names();
  if (names.empty()) std::printf("there are no test data in %s\n", test::test_data_folder().c_str());
  std::printf("| map | queries | another length | most off | pulled taut |\n|---|---|---|---|---|\n");
  bool good = true;
  for (const std::string& name : names) {
    test::MovingAiMap file = test::moving_ai_map(name);
    const Costmap map = test::bare_costmap(file.cells, file.box);
    const std::vector<test::MovingAiQuery> queries = test::moving_ai_queries(name);
    GridSearch search;
    planning::StringPuller string;
    Tally tally;
    for (std::size_t i = 0; i < queries.size(); i += smoke ? queries.size() / 3 : 1)
      ask(map, queries[i], search, string, tally);
    std::printf("| %s | %zu | %zu | %.1e | %.4f |\n", name.c_str(), tally.queries, tally.wrong, tally.most_off,
                tally.pulled / static_cast<double>(tally.queries));
    std::fflush(stdout);
    good = good && tally.wrong == 0 && tally.touched == 0;
  }
  return good ? 0 : 1;
}
