#include "components/observe/map_quality.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kervan::observe {
namespace {

using geometry::Vector2;
using grid::Cell;

constexpr double resolution = 0.1;

/// A room from (0, 0) to (4, 3) with a box and a pillar. Its lower and left walls run along borders of cells, the
/// others through their middles.
DrawnWorld room() {
  DrawnWorld world;
  world.walls = {{{0, 0}, {4.05, 0}}, {{4.05, 0}, {4.05, 3.05}}, {{4.05, 3.05}, {0, 3.05}}, {{0, 3.05}, {0, 0}}};
  world.polygons = {{{1.0, 1.0}, {2.0, 1.0}, {2.0, 2.0}, {1.0, 2.0}}};
  world.circles = {{{3.03, 1.03}, 0.22}};
  return world;
}

const std::vector<Vector2> seeds = {{0.5, 0.5}};

/// The map that knows it all; of the two cells beside a border the one beyond it is occupied.
grid::Occupancy perfect(const MapTruth& truth) {
  grid::Occupancy map(resolution, -1, 1 << 20);
  map.cover({-20, -20, 100, 100});
  for (int y = -2; y < 40; ++y)
    for (int x = -2; x < 60; ++x) {
      const TrueCell is = truth.at({x, y});
      if (is == TrueCell::hidden) continue;
      *map.place({x, y}) = is == TrueCell::free ? 1 : 99;
    }
  for (int x = 0; x < 40; ++x) *map.place({x, 0}) = 1;
  for (int y = 0; y < 30; ++y) *map.place({0, y}) = 1;
  return map;
}

TEST(MapTruth, KnowsWhatCanBeReachedAndWhatIsSolid) {
  const MapTruth truth(room(), seeds, resolution);
  EXPECT_EQ(truth.at({5, 5}), TrueCell::free);
  EXPECT_EQ(truth.at({15, 15}), TrueCell::hidden) << "inside the box";
  EXPECT_EQ(truth.at({60, 5}), TrueCell::hidden) << "outside of the room";
  EXPECT_EQ(truth.at({40, 15}), TrueCell::occupied);
  EXPECT_EQ(truth.at({30, 12}), TrueCell::occupied) << "the pillar's edge";
  EXPECT_EQ(truth.at({30, 10}), TrueCell::hidden) << "the pillar's middle";
  EXPECT_EQ(truth.at({20, 0}), TrueCell::border);
  EXPECT_EQ(truth.at({20, -1}), TrueCell::border);
  EXPECT_EQ(truth.at({20, 1}), TrueCell::free);
  EXPECT_EQ(truth.at({10, 15}), TrueCell::border) << "the box, too, lies along borders";
}

TEST(MapTruth, MeasuresTheDistanceToTheNearestSurface) {
  const MapTruth truth(room(), seeds, resolution);
  EXPECT_NEAR(truth.distance({0.5, 1.5}), 0.5, 1e-12);
  EXPECT_NEAR(truth.distance({1.5, 1.4}), 0.4, 1e-12) << "from within the box";
  EXPECT_NEAR(truth.distance({3.03, 1.50}), 0.25, 1e-12);
}

TEST(MapQuality, OfThePerfectMapIsPerfect) {
  const MapTruth truth(room(), seeds, resolution);
  const MapQuality quality = judge(perfect(truth), truth);
  EXPECT_EQ(quality.accuracy, 1.0);
  EXPECT_EQ(quality.near_accuracy, 1.0);
  EXPECT_EQ(quality.false_occupied, 0.0);
  EXPECT_EQ(quality.false_free, 0.0);
  EXPECT_EQ(quality.coverage, 1.0);
  EXPECT_LT(quality.entropy_bits, 0.09);
  EXPECT_LT(quality.wall_error_m, 0.05);
  EXPECT_GT(quality.judged, 1000u);
}

TEST(MapQuality, CountsWhatIsWrongByItsKind) {
  const MapTruth truth(room(), seeds, resolution);
  grid::Occupancy map = perfect(truth);
  const double judged = static_cast<double>(judge(map, truth).judged);
  for (int x = 5; x < 9; ++x) *map.place({x, 5}) = 80;
  MapQuality quality = judge(map, truth);
  EXPECT_NEAR(quality.accuracy, 1.0 - 4.0 / judged, 1e-12);
  EXPECT_EQ(quality.near_accuracy, quality.accuracy);
  EXPECT_GT(quality.false_occupied, 0.0);
  EXPECT_EQ(quality.false_free, 0.0);
  EXPECT_NEAR(quality.worst_wall_error_m, 0.45, 0.11);

  map = perfect(truth);
  for (int y = 5; y < 9; ++y) *map.place({40, y}) = 20;
  quality = judge(map, truth);
  EXPECT_NEAR(quality.accuracy, 1.0 - 4.0 / judged, 1e-12);
  EXPECT_NEAR(quality.near_accuracy, 1.0 - 2.0 / judged, 1e-12) << "those at the ends of the gap have a neighbour";
  EXPECT_EQ(quality.false_occupied, 0.0);
  EXPECT_GT(quality.false_free, 0.0);
}

TEST(MapQuality, WantsOneOfTheTwoCellsBesideABorder) {
  const MapTruth truth(room(), seeds, resolution);
  grid::Occupancy map = perfect(truth);
  for (int x = 5; x < 9; ++x) {
    *map.place({x, -1}) = 1;
    *map.place({x, 0}) = 99;
  }
  EXPECT_EQ(judge(map, truth).accuracy, 1.0) << "the wall's other side";
  for (int x = 5; x < 15; ++x) *map.place({x, -1}) = *map.place({x, 0}) = 1;
  EXPECT_LT(judge(map, truth).accuracy, 1.0) << "no wall at all";
  EXPECT_GT(judge(map, truth).false_free, 0.0);
}

TEST(MapQuality, HoldsFreeSpaceBehindAWallAgainstTheMap) {
  const MapTruth truth(room(), seeds, resolution);
  grid::Occupancy map = perfect(truth);
  for (int y = 5; y < 9; ++y) *map.place({45, y}) = 5;
  EXPECT_LT(judge(map, truth).accuracy, 1.0);
  EXPECT_GT(judge(map, truth).false_free, 0.0);
  for (int y = 5; y < 9; ++y) *map.place({45, y}) = 95;
  EXPECT_EQ(judge(map, truth).accuracy, 1.0) << "nobody can know how thick a wall is";
}

TEST(MapQuality, OfNoMapIsNothing) {
  const MapTruth truth(room(), seeds, resolution);
  const MapQuality quality = judge(grid::Occupancy(resolution, -1, 1 << 20), truth);
  EXPECT_EQ(quality.judged, 0u);
  EXPECT_EQ(quality.coverage, 0.0);
  for (const double share : {quality.accuracy, quality.near_accuracy, quality.false_occupied, quality.false_free,
                             quality.entropy_bits, quality.wall_error_m, quality.worst_wall_error_m})
    EXPECT_TRUE(std::isnan(share));
}

}  // namespace
}  // namespace kervan::observe
