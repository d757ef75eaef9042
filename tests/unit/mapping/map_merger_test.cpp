#include "components/mapping/map_merger.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace kervan::mapping {
namespace {

constexpr std::size_t plenty = 1 << 24;
constexpr std::size_t tile_cells = std::size_t{grid::tile_side} * grid::tile_side;

using Percent = std::vector<std::int8_t>;

/// A tile whose first cells are these, and the rest unknown.
Percent tile_of(Percent first) {
  first.resize(tile_cells, -1);
  return first;
}

grid::TileView view(const Percent& percent, std::uint64_t session = 1, grid::Cell tile = {0, 0}) {
  return {tile, session, 0.05, grid::tile_side, grid::tile_side, percent};
}

int at(const MapMerger& map, int x, int y = 0) {
  std::int8_t value = 0;
  map.read_percent({x, y, 1, 1}, {&value, 1});
  return value;
}

MapMerger two() { return MapMerger({"r1", "r2"}, 0.05, plenty); }

TEST(MapMerger, OfOneMapIsThatMap) {
  MapMerger map = two();
  const Percent tile = tile_of({-1, 1, 20, 49, 50, 51, 80, 99});
  EXPECT_EQ(map.add(0, view(tile)), TileResult::merged);
  Percent back(tile_cells);
  map.read_percent(grid::cells_of_tile({0, 0}), back);
  EXPECT_EQ(back, tile);
}

TEST(MapMerger, AddsTheEvidenceOfTwo) {
  MapMerger map = two();
  map.add(0, view(tile_of({60, 30, 60, -1})));
  map.add(1, view(tile_of({70, 70, -1, -1})));
  EXPECT_EQ(at(map, 0), 78) << ".6*.7 / (.6*.7 + .4*.3)";
  EXPECT_EQ(at(map, 1), 50);
  EXPECT_EQ(at(map, 2), 60);
  EXPECT_EQ(at(map, 3), -1);
}

TEST(MapMerger, DoesNotCountATileTwice) {
  MapMerger map = two();
  for (int i = 0; i < 5; ++i) map.add(0, view(tile_of({70})));
  EXPECT_EQ(at(map, 0), 70);
  map.add(0, view(tile_of({40})));
  EXPECT_EQ(at(map, 0), 40) << "only the newest word counts";
}

TEST(MapMerger, KeepsWhatAMapperSaidInAnEarlierLife) {
  MapMerger map = two();
  map.add(0, view(tile_of({70, 20}), 1));
  map.add(0, view(tile_of({90}), 1, {3, 3}));
  map.take_touched();
  EXPECT_EQ(map.add(0, view(tile_of({-1, 60}), 2)), TileResult::merged);
  EXPECT_EQ(at(map, 0), 70) << "the new mapper knows nothing of it";
  EXPECT_EQ(at(map, 1), 27) << ".2*.6 / (.2*.6 + .8*.4)";
  EXPECT_EQ(at(map, 192, 192), 90);
  EXPECT_EQ(map.take_touched(), (std::vector<grid::Cell>{{0, 0}}));
  EXPECT_EQ(map.add(0, view(tile_of({1, 1}), 1)), TileResult::from_the_past) << "still under way when it died";
  EXPECT_EQ(at(map, 0), 70);
}

TEST(MapMerger, RefusesTilesThatDoNotFit) {
  MapMerger map = two();
  const Percent good = tile_of({70});
  grid::TileView tile = view(good);
  tile.resolution = 0.1;
  EXPECT_EQ(map.add(0, tile), TileResult::refused_resolution);
  tile.resolution = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(map.add(0, tile), TileResult::refused_resolution);
  tile.resolution = static_cast<double>(0.05f);
  EXPECT_EQ(map.add(0, tile), TileResult::merged) << "as a float carries it";
  tile = view(good);
  tile.columns = 32;
  EXPECT_EQ(map.add(0, tile), TileResult::refused_size);
  tile = view(good);
  tile.percent = tile.percent.first(100);
  EXPECT_EQ(map.add(0, tile), TileResult::refused_size);
  for (const std::int8_t value : {std::int8_t{101}, std::int8_t{-2}})
    EXPECT_EQ(map.add(0, view(tile_of({value}))), TileResult::refused_value);
  EXPECT_EQ(map.add(0, view(good, 1, {std::numeric_limits<int>::min(), 0})), TileResult::refused_memory);
  EXPECT_EQ(map.add(0, view(good, 1, {1 << 20, 1 << 20})), TileResult::refused_memory);
  EXPECT_EQ(at(map, 0), 70) << "what it has it keeps";
}

TEST(MapMerger, GoesOnFromItsCheckpointInTheSameRun) {
  MapMerger map = two();
  map.add(0, view(tile_of({70, 20}), 1));
  map.add(0, view(tile_of({70, 20}), 5));
  map.add(1, view(tile_of({60}), 3, {-1, 0}));
  MapMerger restored = two();
  restored.restore(grid::checkpoint_of(grid::to_bytes(map.checkpoint("runs/a"))), "runs/a");
  EXPECT_EQ(at(restored, 0), at(map, 0));
  EXPECT_EQ(at(restored, -64), 60);
  EXPECT_EQ(restored.take_touched().size(), 2u) << "all of it is to be said again";
  EXPECT_EQ(restored.add(0, view(tile_of({10}), 1)), TileResult::from_the_past);
  restored.add(0, view(tile_of({60}), 5));
  map.add(0, view(tile_of({60}), 5));
  EXPECT_EQ(at(restored, 0), at(map, 0)) << "the mapper lives on, and its tile replaces the one before";
}

TEST(MapMerger, TakesTheMapOfAnotherRunForGranted) {
  MapMerger map = two();
  map.add(0, view(tile_of({70}), 0));
  MapMerger restored = two();
  restored.restore(map.checkpoint("runs/a"), "runs/b");
  restored.add(0, view(tile_of({60}), 0));
  EXPECT_EQ(at(restored, 0), 78) << "the sessions have the same number, and are not the same";
  MapMerger others({"r3"}, 0.05, plenty);
  others.restore(map.checkpoint("runs/a"), "runs/a");
  EXPECT_EQ(at(others, 0), 70) << "of a mapper that is not there any more";
}

TEST(MapMerger, DoesNotGoOnFromAMapOfOtherCellsOrTooLarge) {
  MapMerger map = two();
  map.add(0, view(tile_of({70})));
  MapMerger coarse({"r1"}, 0.1, plenty), small({"r1"}, 0.05, 100);
  try {
    coarse.restore(map.checkpoint("runs/a"), "runs/a");
    FAIL() << "it was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()), "the checkpoint has cells of 0.050000 m, the map of 0.100000 m");
  }
  EXPECT_THROW(small.restore(map.checkpoint("runs/a"), "runs/a"), std::invalid_argument);
  EXPECT_TRUE(small.box().empty());
}

}  // namespace
}  // namespace kervan::mapping
