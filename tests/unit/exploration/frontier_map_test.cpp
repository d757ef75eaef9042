#include "components/exploration/frontier_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

namespace kervan::exploration {
namespace {

using geometry::Vector2;

constexpr double resolution = 0.05;
constexpr std::int8_t occupied = 100, free_cell = 0, unknown_cell = -1;

/// What a cell is, by the middle of it.
using Drawing = std::function<std::int8_t(const Vector2&)>;

std::vector<std::int8_t> tile_of(const Drawing& drawing, const grid::Cell& tile) {
  std::vector<std::int8_t> percent;
  const grid::CellBox box = grid::cells_of_tile(tile);
  for (int y = box.y; y < box.y + box.rows; ++y)
    for (int x = box.x; x < box.x + box.columns; ++x) percent.push_back(drawing(grid::center_of({x, y}, resolution)));
  return percent;
}

bool put(FrontierMap& map, const grid::Cell& tile, std::vector<std::int8_t> percent) {
  return map.put({tile, 1, resolution, grid::tile_side, grid::tile_side, percent});
}

/// Tiles of 3.2 m, from the origin on.
void put_all(FrontierMap& map, const Drawing& drawing, int columns, int rows) {
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) put(map, {x, y}, tile_of(drawing, {x, y}));
}

bool in(const Vector2& p, double x0, double y0, double x1, double y1) {
  return p.x() > x0 && p.y() > y0 && p.x() < x1 && p.y() < y1;
}

/// A room from (0.5, 0.5) to (5.9, 5.9) with a wall of 0.2 m round it and a door of 1.2 m in the right one; what lies
/// beyond is not known.
std::int8_t room(const Vector2& p) {
  if (in(p, 0.5, 0.5, 5.9, 5.9) || in(p, 5.8, 2.4, 6.2, 3.6)) return free_cell;
  return in(p, 0.3, 0.3, 6.1, 6.1) ? occupied : unknown_cell;
}

TEST(FrontierMap, TheFrontierOfARoomIsItsDoor) {
  FrontierMap map({});
  put_all(map, room, 3, 3);
  const auto& found = map.find({2, 2});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].place.x(), 6.1, 0.15);
  EXPECT_NEAR(found[0].place.y(), 3.0, 0.15);
  EXPECT_NEAR(found[0].length, 0.6, 0.25) << "as far as a robot of 0.35 m fits into the door";
  const double straight = (found[0].place - Vector2(2, 2)).norm();
  EXPECT_GE(found[0].distance, straight - 0.2);
  EXPECT_LE(found[0].distance, 1.09 * straight + 0.4) << "in moves to eight neighbours";
  EXPECT_TRUE(map.open_near({6.0, 3.0}, 0.5));
  EXPECT_FALSE(map.open_near({3.0, 3.0}, 0.5));
  EXPECT_NEAR(map.free_area(), 5.4 * 5.4 + 0.3 * 1.2, 0.2);
}

TEST(FrontierMap, DistancesLeadRoundWalls) {
  FrontierMap map({});
  put_all(
      map,
      [](const Vector2& p) {
        if (in(p, 3.0, 0.0, 3.2, 7.5)) return occupied;  // a wall, passed at its upper end
        return in(p, 0.2, 0.2, 9.4, 9.4) ? (p.x() > 8 ? unknown_cell : free_cell) : occupied;
      },
      3, 3);
  const auto& found = map.find({1, 1});
  ASSERT_FALSE(found.empty());
  for (const Frontier& frontier : found) {
    EXPECT_NEAR(frontier.place.x(), 7.9, 0.2);
    const Vector2 corner(3.1, 7.9);
    const double way = (corner - Vector2(1, 1)).norm() + (frontier.place - corner).norm();
    EXPECT_NEAR(frontier.distance, way, 0.1 * way) << frontier.place.transpose();
  }
}

TEST(FrontierMap, WhatCannotBeReachedIsNone) {
  FrontierMap map({});
  put_all(
      map, [](const Vector2& p) { return in(p, 5.8, 2.4, 6.2, 3.6) && p.x() > 5.9 ? occupied : room(p); }, 3, 3);
  EXPECT_TRUE(map.find({2, 2}).empty()) << "the door is shut";
  FrontierMap narrow({});
  put_all(
      narrow, [](const Vector2& p) { return in(p, 5.8, 2.4, 6.2, 3.6) && p.y() > 2.9 ? occupied : room(p); }, 3, 3);
  EXPECT_TRUE(narrow.find({2, 2}).empty()) << "0.5 m are too narrow for a robot of 0.7 m";
}

TEST(FrontierMap, LongFrontiersAreCutAndShortOnesLeftOut) {
  const Drawing strip = [](const Vector2& p) {
    return in(p, 0.0, 0.0, 12.8, 2.0) ? free_cell : p.y() > 2.0 ? unknown_cell : occupied;
  };
  FrontierMap map({.most_length = 3.0});
  put_all(map, strip, 4, 1);
  const auto& found = map.find({6, 1});
  EXPECT_GE(found.size(), 4u);
  for (const Frontier& frontier : found) EXPECT_LE(frontier.length, 3.0);
  FrontierMap blind({.least_length = 100.0, .most_length = 100.0});
  put_all(blind, strip, 4, 1);
  EXPECT_TRUE(blind.find({6, 1}).empty());
}

TEST(FrontierMap, ARobotThatStandsInTheUnknownOrAtAWallFindsItsWayOut) {
  FrontierMap map({});
  put_all(
      map, [](const Vector2& p) { return (p - Vector2(2, 2)).norm() < 0.3 ? unknown_cell : room(p); }, 3, 3);
  EXPECT_FALSE(map.find({2, 2}).empty()) << "its laser does not see what it stands on";
  EXPECT_FALSE(map.find({0.6, 0.6}).empty()) << "too near to a wall";
  EXPECT_TRUE(map.find({9.0, 9.0}).empty()) << "there is nothing within a metre";
  EXPECT_TRUE(map.find({std::numeric_limits<double>::quiet_NaN(), 0}).empty());
}

TEST(FrontierMap, FollowsChangesAsIfItWereMadeAnew) {
  FrontierMap follows({});
  // What is known grows from the left to the right, in steps that do not fit the tiles.
  for (double edge = 1.0; edge < 6.5; edge += 0.7) {
    const Drawing drawing = [edge](const Vector2& p) { return p.x() < edge ? room(p) : unknown_cell; };
    put_all(follows, drawing, 3, 3);
    const auto found = follows.find({0.9, 2});
    FrontierMap anew({});
    put_all(anew, drawing, 3, 3);
    const auto expected = anew.find({0.9, 2});
    ASSERT_EQ(found.size(), expected.size()) << edge;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].place, expected[i].place);
      EXPECT_EQ(found[i].length, expected[i].length);
      EXPECT_EQ(found[i].distance, expected[i].distance);
    }
    EXPECT_EQ(follows.free_area(), anew.free_area());
  }
}

TEST(FrontierMap, HasNoneWithoutAMapAndInOneThatIsKnown) {
  FrontierMap map({});
  EXPECT_TRUE(map.empty());
  EXPECT_TRUE(map.find({0, 0}).empty());
  EXPECT_FALSE(map.open_near({0, 0}, 1.0));
  put_all(
      map,
      [](const Vector2& p) { return in(p, 0.3, 0.3, 6.1, 6.1) && !in(p, 0.5, 0.5, 5.9, 5.9) ? occupied : free_cell; },
      2, 2);
  EXPECT_FALSE(map.empty());
  EXPECT_TRUE(map.find({2, 2}).empty());
}

TEST(FrontierMap, LeavesOutTilesThatDoNotFit) {
  FrontierMap map({.most_bytes = 64 * 64 * 4});
  const auto tile = tile_of(room, {0, 0});
  ASSERT_TRUE(put(map, {0, 0}, tile));
  EXPECT_FALSE(map.put({{1, 0}, 1, 0.1, grid::tile_side, grid::tile_side, tile}));
  EXPECT_EQ(map.why(), "cells of another size are left out");
  EXPECT_FALSE(map.put({{1, 0}, 1, resolution, 32, 32, tile}));
  EXPECT_EQ(map.why(), "tiles of another size are left out");
  EXPECT_FALSE(put(map, {1, 0}, std::vector<std::int8_t>(tile.size(), 101)));
  EXPECT_EQ(map.why(), "a percentage is none, its tile is left out");
  EXPECT_FALSE(put(map, {1 << 30, 0}, tile));
  EXPECT_EQ(map.why(), "a tile too far from the map's origin is left out");
  EXPECT_FALSE(put(map, {100, 0}, tile));
  EXPECT_EQ(map.why(), "memory is used up, tiles beyond the map are left out");
  EXPECT_FALSE(map.find({2, 2}).empty()) << "what was there is still there";
}

}  // namespace
}  // namespace kervan::exploration
