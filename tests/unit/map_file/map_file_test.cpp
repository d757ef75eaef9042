#include "framework/map_file/map_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>

#include "framework/map_file/image.hpp"

namespace kervan::map_file {
namespace {

namespace fs = std::filesystem;

class SavedMap : public testing::Test {
 protected:
  SavedMap() { fs::create_directories(folder_); }
  ~SavedMap() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  fs::path folder_ = fs::temp_directory_path() / ("kervan_map_file_" + std::to_string(getpid()));
};

/// 3 x 2 cells of every kind.
GridMap small() { return {{-1.5, 2.0 / 3.0, 0.25}, 0.05, 3, 2, {0, 40, 100, -1, 66, 19}}; }

TEST_F(SavedMap, InModeRawComesBackAsItWas) {
  save(small(), path("map.yaml"), Mode::raw);
  const GridMap back = load(path("map.yaml"));
  EXPECT_EQ(back.origin, small().origin);
  EXPECT_EQ(back.resolution, 0.05);
  EXPECT_EQ(back.columns, 3);
  EXPECT_EQ(back.rows, 2);
  EXPECT_EQ(back.occupancy, small().occupancy);
  EXPECT_EQ(back.occupied_above, 65.0);
}

TEST_F(SavedMap, InModeTrinaryComesBackAsOccupiedFreeAndUnknown) {
  save(small(), path("map.yaml"), Mode::trinary);
  const GridMap back = load(path("map.yaml"));
  EXPECT_EQ(back.origin, small().origin);
  EXPECT_EQ(back.occupancy, (std::vector<std::int8_t>{0, -1, 100, -1, 100, 0}));
  const Image picture = load_image(path("map.png"));
  EXPECT_EQ(picture.pixels[5].shade, 0) << "the last pixel of the picture is the lower right cell";
  EXPECT_EQ(picture.pixels[0].shade, 205);
}

TEST_F(SavedMap, AsPgmComesBackAsItWas) {
  save(small(), path("map.yaml"), Mode::raw, Format::pgm);
  EXPECT_TRUE(read_file(path("map.pgm")).starts_with("P5\n3 2\n255\n"));
  EXPECT_EQ(load(path("map.yaml")).occupancy, small().occupancy);
  EXPECT_FALSE(fs::exists(path("map.png")));
}

TEST_F(SavedMap, ReplacesAnEarlierOneAndLeavesNothingElse) {
  save(small(), path("map.yaml"), Mode::raw);
  GridMap other = small();
  other.occupancy[0] = 77;
  save(other, path("map.yaml"), Mode::raw);
  EXPECT_EQ(load(path("map.yaml")).occupancy, other.occupancy);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 2);
}

TEST_F(SavedMap, SaysWhyItCannotBeWritten) {
  const auto refusal = [&](const GridMap& map, const std::string& name) -> std::string {
    try {
      save(map, name, Mode::raw);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(small(), "/gone/map.yaml"), "/gone/map.png: cannot be written: No such file or directory");
  EXPECT_EQ(refusal(GridMap{}, "map.yaml"), "map.yaml: the picture has no pixels");
}

TEST(Picture, ComesBackFromPngAndPgm) {
  const Image image{3, 2, {{0}, {1}, {127}, {128}, {254}, {255}}};
  for (const std::string& bytes : {to_png(image), to_pgm(image)}) {
    const Image back = parse_image(bytes);
    ASSERT_EQ(back.columns, 3);
    ASSERT_EQ(back.rows, 2);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(back.pixels[i].shade, image.pixels[i].shade);
  }
  const Image clear{1, 1, {{7, 0}}};
  EXPECT_EQ(parse_image(to_png(clear)).pixels[0].opacity, 0);
}

TEST(Shades, InModeScaleAreProbabilitiesBetweenTheThresholds) {
  const fs::path folder = fs::temp_directory_path() / ("kervan_shades_" + std::to_string(getpid()));
  fs::create_directories(folder);
  replace_file((folder / "m.pgm").string(), to_pgm({4, 1, {{0}, {100}, {150}, {255}}}));
  replace_file((folder / "m.yaml").string(), "image: m.pgm\nresolution: 1\norigin: [0, 0, 0]\nmode: scale\n");
  const GridMap map = load((folder / "m.yaml").string());
  EXPECT_EQ(map.occupancy, (std::vector<std::int8_t>{100, 90, 48, 0}));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace kervan::map_file
