#include "components/grid/tile.hpp"

#include <gtest/gtest.h>

#include "components/grid/picture.hpp"
#include "framework/map_file/image.hpp"

namespace kervan::grid {
namespace {

constexpr std::size_t plenty = 1 << 20;

TEST(Tile, IsPutWhereItsCellsLie) {
  std::vector<std::int8_t> percent(std::size_t{tile_side} * tile_side, -1);
  percent[1] = 70;
  percent[tile_side] = 20;
  Occupancy map(0.05, -1, plenty);
  const TileView tile{{-1, 2}, 1, 0.05, tile_side, tile_side, percent};
  EXPECT_EQ(fault_of(tile, 0.05), TileFault::none);
  EXPECT_EQ(put(tile, map), Growth::grown);
  EXPECT_EQ(map.at({-63, 128}), 70);
  EXPECT_EQ(map.at({-64, 129}), 20);
  EXPECT_EQ(map.at({-64, 128}), -1);
  Occupancy small(0.05, -1, 100);
  EXPECT_EQ(put(tile, small), Growth::refused);
  EXPECT_TRUE(small.box().empty());
}

TEST(Tile, ThatDoesNotFitIsToldByWhatIsWrong) {
  std::vector<std::int8_t> percent(std::size_t{tile_side} * tile_side, 0);
  const auto side = static_cast<std::uint32_t>(tile_side);
  const auto fault = [&](Cell place, double resolution, std::uint32_t columns) {
    return fault_of({place, 1, resolution, columns, side, percent}, 0.05);
  };
  EXPECT_EQ(fault({0, 0}, static_cast<double>(0.05f), side), TileFault::none);
  EXPECT_EQ(fault({0, 0}, 0.1, side), TileFault::resolution);
  EXPECT_EQ(fault({0, 0}, std::nan(""), side), TileFault::resolution);
  EXPECT_EQ(fault({0, 0}, 0.05, 65), TileFault::size);
  EXPECT_EQ(fault({1 << 30, 0}, 0.05, side), TileFault::place);
  EXPECT_EQ(fault({0, std::numeric_limits<int>::min()}, 0.05, side), TileFault::place);
  percent[17] = 101;
  EXPECT_EQ(fault({0, 0}, 0.05, side), TileFault::value);
  percent[17] = -2;
  EXPECT_EQ(fault({0, 0}, 0.05, side), TileFault::value);
  percent.pop_back();
  EXPECT_EQ(fault({0, 0}, 0.05, side), TileFault::size);
}

TEST(Picture, IsOfTheKnownPartAndLiesAsPicturesDo) {
  Occupancy map(0.05, -1, plenty);
  EXPECT_TRUE(picture_of(map).box.empty());
  map.cover({0, 0, 64, 64});
  EXPECT_TRUE(picture_of(map).box.empty()) << "there are cells, but nothing is known of them";
  *map.place({5, 7}) = 100;
  *map.place({6, 9}) = 0;
  *map.place({5, 8}) = 40;
  const Picture picture = picture_of(map);
  EXPECT_EQ(picture.box, (CellBox{5, 7, 2, 3}));
  const map_file::Image image = map_file::parse_image(picture.png);
  ASSERT_EQ(image.columns, 2);
  ASSERT_EQ(image.rows, 3);
  const auto pixel = [&](std::size_t i) { return std::pair<int, int>{image.pixels[i].shade, image.pixels[i].opacity}; };
  EXPECT_EQ(pixel(1), std::pair(255, 255)) << "free, above, to the right";
  EXPECT_EQ(pixel(2), std::pair(153, 255)) << "in between";
  EXPECT_EQ(pixel(4), std::pair(0, 255)) << "occupied, below, to the left";
  for (const std::size_t unknown : {0, 3, 5}) EXPECT_EQ(pixel(unknown).second, 0) << unknown;
}

}  // namespace
}  // namespace kervan::grid
