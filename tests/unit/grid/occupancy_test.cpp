#include "components/grid/occupancy.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "components/grid/log_odds.hpp"

namespace kervan::grid {
namespace {

constexpr std::size_t plenty = 1 << 20;

TEST(Occupancy, OfARectangleIsUnknownOutsideOfTheGrid) {
  Grid<LogOdds> grid(0.05, 0, plenty);
  grid.cover({0, 0, 64, 64});
  *grid.place({0, 0}) = log_odds_of(0.8);
  *grid.place({1, 1}) = log_odds_of(0.1);
  std::vector<std::int8_t> percent(9);
  read_percent(grid, {-1, -1, 3, 3}, percent);
  EXPECT_EQ(percent, (std::vector<std::int8_t>{-1, -1, -1, -1, 80, -1, -1, -1, 10}));
  read_percent(grid, {0, 0, 3, 3}, percent);
  EXPECT_EQ(percent, (std::vector<std::int8_t>{80, -1, -1, -1, 10, -1, -1, -1, -1}));
}

TEST(Occupancy, GoesToAMapFileAndBack) {
  Occupancy grid(0.05, -1, plenty);
  grid.cover({-64, 64, 64, 64});
  *grid.place({-64, 64}) = 3;
  *grid.place({-1, 127}) = 97;
  const map_file::GridMap map = to_map_file(grid);
  EXPECT_EQ(map.origin.position(), geometry::Vector2(-3.2, 3.2));
  EXPECT_EQ(map.columns, 64);
  Occupancy back = from_map_file(map, plenty);
  EXPECT_EQ(back.box(), grid.box());
  EXPECT_EQ(back.values(), grid.values());
  EXPECT_EQ(back.take_touched().size(), 1u);
  EXPECT_EQ(to_map_file(Occupancy(0.05, -1, plenty)).occupancy, (std::vector<std::int8_t>{-1}));
}

TEST(Occupancy, TakesNoMapThatIsTurnedTooFarAwayOrTooLarge) {
  const auto refusal = [](const map_file::GridMap& map, std::size_t most) -> std::string {
    try {
      from_map_file(map, most);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  map_file::GridMap map{{0.0, 0.0, 0.5}, 0.05, 3, 1, {0, 0, 0}};
  EXPECT_EQ(refusal(map, plenty), "the map is turned by 0.500000 rad against its frame; allowed: 0");
  map.origin = {1e6, 0.0, 0.0};
  EXPECT_EQ(refusal(map, plenty), "the map's corner is too far from the origin of its frame");
  map.origin = {};
  EXPECT_EQ(refusal(map, 4095), "the map of 3 x 1 cells needs more than the allowed 4095 bytes");
  EXPECT_EQ(refusal(map, 4096), "");
}

}  // namespace
}  // namespace kervan::grid
