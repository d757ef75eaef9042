#include "components/grid/grid.hpp"

#include <gtest/gtest.h>

#include "components/grid/certainty.hpp"
#include "components/grid/log_odds.hpp"
#include "components/grid/masses.hpp"

namespace kervan::grid {
namespace {

constexpr std::size_t plenty = 64 << 20;

TEST(Cells, LieToTheRightAndAboveTheirCorner) {
  EXPECT_EQ(cell_of({0.0, 0.0}, 0.05), (Cell{0, 0}));
  EXPECT_EQ(cell_of({0.12, -0.01}, 0.05), (Cell{2, -1}));
  EXPECT_EQ(cell_of(center_of({-7, 9}, 0.05), 0.05), (Cell{-7, 9}));
  EXPECT_FALSE(has_cell({0.0, std::nan("")}));
  EXPECT_FALSE(has_cell({2e6, 0.0}));
}

TEST(Cells, TilesAreCountedDownwardsThroughZero) {
  EXPECT_EQ(tile_of(0), 0);
  EXPECT_EQ(tile_of(63), 0);
  EXPECT_EQ(tile_of(64), 1);
  EXPECT_EQ(tile_of(-1), -1);
  EXPECT_EQ(tile_of(-64), -1);
  EXPECT_EQ(tile_of(-65), -2);
}

TEST(Grid, GrowsInEveryDirectionAndKeepsItsValues) {
  Grid<int> grid(0.1, -1, plenty);
  EXPECT_EQ(grid.cover({0, 0, 1, 1}), Growth::grown);
  EXPECT_EQ(grid.box(), (CellBox{0, 0, 64, 64}));
  *grid.place({3, 5}) = 7;
  for (const CellBox& box : {CellBox{-1, 0, 1, 1}, {0, -300, 1, 1}, {500, 0, 1, 1}, {0, 1000, 1, 1}}) {
    EXPECT_EQ(grid.cover(box), Growth::grown);
    EXPECT_TRUE(grid.box().contains(box));
    EXPECT_EQ(grid.at({3, 5}), 7);
    EXPECT_EQ(grid.at({box.x, box.y}), -1);
    EXPECT_EQ(grid.box().x % tile_side, 0);
    EXPECT_EQ(grid.box().columns % tile_side, 0);
  }
  EXPECT_EQ(grid.cover({-1, -300, 100, 1000}), Growth::fits);
  EXPECT_EQ(grid.at({100'000, 0}), -1) << "outside";
}

TEST(Grid, IsNotCopiedAtEveryStepOfASteadyGrowth) {
  Grid<char> grid(0.1, 0, plenty);
  int copies = 0;
  for (int x = 0; x < 64 * 200; ++x)
    if (grid.cover({x, 0, 1, 1}) == Growth::grown) ++copies;
  EXPECT_LT(copies, 30);
}

TEST(Grid, RefusesToGrowBeyondItsMemoryAndStaysAsItIs) {
  Grid<std::int16_t> grid(0.05, 0, 64 * 64 * 4 * sizeof(std::int16_t));  // four tiles
  EXPECT_EQ(grid.cover({0, 0, 128, 128}), Growth::grown) << "the last tile that fits, without any to spare";
  *grid.place({127, 127}) = 9;
  EXPECT_EQ(grid.cover({128, 0, 1, 1}), Growth::refused);
  EXPECT_EQ(grid.cover({-1'000'000'000, 0, 2'000'000'000, 1}), Growth::refused);
  EXPECT_EQ(grid.box(), (CellBox{0, 0, 128, 128}));
  EXPECT_EQ(grid.at({127, 127}), 9);
}

TEST(Grid, TellsEachTouchedTileOnceInTheirOrder) {
  Grid<int> grid(0.1, 0, plenty);
  grid.cover({-64, -64, 192, 128});
  EXPECT_TRUE(grid.take_touched().empty());
  grid.touch({-1, -1, 2, 2});
  grid.touch({0, 0, 1, 1});
  EXPECT_EQ(grid.take_touched(), (std::vector<Cell>{{-1, -1}, {0, -1}, {-1, 0}, {0, 0}}));
  EXPECT_TRUE(grid.take_touched().empty());
  grid.touch({64, 63, 1, 1});
  grid.cover({-1000, -1000, 1, 1});
  EXPECT_EQ(grid.take_touched(), (std::vector<Cell>{{1, 0}})) << "growing forgets nothing and touches nothing";
}

TEST(LogOdds, StandForAProbabilityAndEndAtOnePerCent) {
  for (const double p : {0.01, 0.175, 0.4773, 0.5, 0.5227, 0.825, 0.99})
    EXPECT_NEAR(probability_of(log_odds_of(p)), p, 2e-5);
  EXPECT_EQ(log_odds_of(1.0), 32767);
  EXPECT_EQ(log_odds_of(0.0), -32767);
  EXPECT_EQ(log_odds_of(std::nan("")), 0);
  EXPECT_NEAR(probability_of(added(32767, 32767)), 0.99, 2e-5);
  EXPECT_NEAR(probability_of(added(-32768, -32768)), 0.01, 2e-5);
  EXPECT_EQ(percent_of(LogOdds{0}), -1);
  EXPECT_EQ(percent_of(log_odds_of(0.7)), 70);
  EXPECT_EQ(percent_of(LogOdds{-32768}), 1);
}

TEST(Masses, ThatContradictEachOtherEntirelyHaveNoSum) {
  const Combination sum = combine({1.0, 0.0}, {0.0, 1.0});
  EXPECT_EQ(sum.conflict, 1.0);
  EXPECT_EQ(sum.masses.occupied, 1.0);
  EXPECT_EQ(percent_of(MassCell{}), -1);
  EXPECT_EQ(percent_of(MassCell{0.6f, 0.2f}), 70);
}

TEST(Certainty, CountsUpByThreeAndDownByOneBetweenZeroAndFifteenHimm) {
  Certainty cell;
  EXPECT_EQ(percent_of(cell), -1);
  cell.lower();
  EXPECT_EQ(cell.value(), 0);
  EXPECT_EQ(percent_of(cell), 0);
  cell.raise();
  EXPECT_EQ(cell.value(), 3);
  cell.lower();
  EXPECT_EQ(cell.value(), 2);
  for (int i = 0; i < 9; ++i) cell.raise();
  EXPECT_EQ(cell.value(), 15);
  EXPECT_EQ(percent_of(cell), 100);
  for (int i = 0; i < 20; ++i) cell.lower();
  EXPECT_EQ(cell.value(), 0);
  EXPECT_TRUE(cell.known());
}

}  // namespace
}  // namespace kervan::grid
