/// What a step of a controller costs, beside the same law written as its formulas stand.
#include <cmath>
#include <random>
#include <vector>

#include "components/control/vff.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/statistics.hpp"

namespace {

using namespace kervan;
using bench::say;
using control::CertaintyWindow;
using geometry::Vector2;

/// Eqs. 1 and 2 cell by cell.
Vector2 textbook_repulsion(const CertaintyWindow& window, const Vector2& robot, double f_cr) {
  Vector2 sum = Vector2::Zero();
  for (int row = 0; row < control::window_side; ++row)
    for (int column = 0; column < control::window_side; ++column) {
      const Vector2 cell = window.origin + window.resolution * Vector2(column + 0.5, row + 0.5);
      const double d = (robot - cell).norm();
      if (d < 0.5 * window.resolution) continue;
      const double certainty = window.cells[static_cast<std::size_t>(row * control::window_side + column)];
      sum += f_cr * certainty / (d * d) * (robot - cell) / d;
    }
  return sum;
}

grid::Grid<grid::Certainty> random_cells(double share) {
  grid::Grid<grid::Certainty> cells(0.1, {}, std::size_t{1} << 22);
  cells.cover({-128, -128, 256, 256});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> draw;
  for (int y = -128; y < 128; ++y)
    for (int x = -128; x < 128; ++x)
      for (int echoes = 0; draw(random) < share && echoes < 5; ++echoes) cells.place({x, y})->raise();
  return cells;
}

void bench_vff(double share, bool smoke) {
  const auto cells = random_cells(share);
  control::VirtualForceField field({});
  CertaintyWindow window;
  const int rounds = smoke ? 3 : 101, steps = smoke ? 10 : 2000;
  std::vector<double> step_ns, cut_ns, textbook_ns;
  double sink = 0.0;
  const auto time_of = [&](auto work) {
    const auto start = bench::now_ns();
    for (int i = 0; i < steps; ++i) work(Vector2(0.01 * (i % 1000) - 5.0, 0.02 * (i % 500) - 5.0));
    return static_cast<double>(bench::now_ns() - start) / steps;
  };
  for (int round = 0; round < rounds; ++round) {
    cut_ns.push_back(time_of([&](const Vector2& at) {
      control::cut_window(cells, at, window);
      sink += window.cells[100];
    }));
    control::cut_window(cells, {0.05, 0.05}, window);
    step_ns.push_back(time_of([&](const Vector2& at) {
      sink += field.step({{0.05, 0.05, at.x()}, {0.5, 0.0}}, at, window).twist.angular;
    }));
    textbook_ns.push_back(time_of(
        [&](const Vector2& at) { sink += textbook_repulsion(window, Vector2(0.05, 0.05) + 1e-3 * at, 0.02).x(); }));
  }
  const double step = bench::median(step_ns);
  say("| %.0f %% | %.0f ns | 300 ns at most | %.0f ns | %.0f ns | %.1f |\n", 100.0 * share, step, bench::median(cut_ns),
      bench::median(textbook_ns), bench::median(textbook_ns) / step);
  if (std::isnan(sink)) say("not a number\n");
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = bench::begin(argc, argv, "Control");
  say("\n## control/vff\n\nA step with a window of 33 x 33 cells, and what it takes to cut the window out of the grid; "
      "medians of "
      "alternating\nrounds. The textbook has eqs. 1 and 2 alone, cell by cell.\n\n"
      "| cells with an echo | step | wanted | cutting the window | textbook | ratio |\n|---|---|---|---|---|---|\n");
  for (const double share : {0.0, 0.02, 0.5}) bench_vff(share, smoke);
  return bench::end();
}
