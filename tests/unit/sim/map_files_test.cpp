// Maps of other programs: pictures, ROS, ARIA.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "framework/map_file/image.hpp"
#include "sim/files/aria_map.hpp"
#include "sim/files/world_file.hpp"
#include "tests/unit/config/refused.hpp"

namespace kervan::sim {
namespace {

using test::refused;
namespace fs = std::filesystem;

/// Files in a folder of their own, which the messages begin with.
class MapFiles : public testing::Test {
 protected:
  MapFiles() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / ("kervan_maps_" + std::string(test->name()) + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  ~MapFiles() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& bytes) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  /// What loading the file is refused with, without the folder's name.
  std::string refusal(const std::string& name, const std::string& text) {
    const std::string path = write(name, text);
    std::string message = refused([&] { load_world(path); });
    const std::string prefix = folder_.string() + "/";
    for (auto at = message.find(prefix); at != std::string::npos; at = message.find(prefix))
      message.erase(at, prefix.size());
    return message;
  }

  fs::path folder_;
};

/// 3 x 2 pixels; below, from the left: black, grey (205, unknown), white.
const std::string small_pgm =
    std::string("P5\n# drawn by hand\n3 2\n255\n") + "\xff\xff\xff" + std::string(1, '\0') + "\xcd\xff";

/// The same picture as an 8-bit grey PNG.
const std::string small_png(
    "\211\120\116\107\015\012\032\012\000\000\000\015\111\110\104\122\000\000\000\003\000\000\000\002\010"
    "\000\000\000\000\270\037\071\306\000\000\000\020\111\104\101\124\170\234\143\370\377\377\077\003\303"
    "\331\377\000\024\217\004\312\321\133\070\306\000\000\000\000\111\105\116\104\256\102\140\202",
    73);

const std::string ros = "image: m.pgm\nresolution: 0.5\norigin: [1.0, -2.0, 0.0]\n";

double ray_right(const World& world, Vector2 origin) {
  const auto hit = world.cast({origin, {1.0, 0.0}});
  return hit ? hit->distance : infinity;
}

TEST_F(MapFiles, AMapOfRosLiesWhereItsOriginSays) {
  write("m.pgm", small_pgm);
  const World world = load_world(write("office.yaml", ros + "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"));
  EXPECT_EQ(world.name(), "office");
  EXPECT_NEAR(ray_right(world, {0.0, -1.75}), 1.0, 1e-6) << "the lower left pixel";
  EXPECT_EQ(ray_right(world, {0.0, -1.25}), infinity) << "the upper row";
  EXPECT_EQ(ray_right(world, {1.6, -1.75}), infinity) << "unknown cells are free";
}

TEST_F(MapFiles, AMapOfRosMayBeTurnedAndNegated) {
  write("m.pgm", small_pgm);
  const World turned =
      load_world(write("turned.yaml", "image: m.pgm\nresolution: 0.5\norigin: [0, 0, 1.5707963267948966]\n"));
  EXPECT_EQ(turned.nearest({-0.25, 0.25})->distance, 0.0);
  EXPECT_GT(turned.nearest({0.25, 0.25})->distance, 0.2);
  const World negated = load_world(write("negated.yaml", ros + "negate: 1\n"));
  EXPECT_GT(negated.nearest({1.25, -1.75})->distance, 0.0) << "black is free";
  EXPECT_EQ(negated.nearest({1.75, -1.75})->distance, 0.0) << "205 of 255 is above 0.65";
  EXPECT_EQ(negated.nearest({1.25, -1.25})->distance, 0.0);
}

TEST_F(MapFiles, InRawModeAShadeIsAProbabilityInPercent) {
  write("m.pgm", std::string("P2 4 1 255  100 66 65 101"));
  const World world = load_world(write("raw.yaml", "image: m.pgm\nresolution: 1\norigin: [0, 0, 0]\nmode: raw\n"));
  EXPECT_EQ(world.nearest({0.5, 0.5})->distance, 0.0);
  EXPECT_EQ(world.nearest({1.5, 0.5})->distance, 0.0);
  EXPECT_GT(world.nearest({2.5, 0.5})->distance, 0.0) << "65 is not above the threshold";
  EXPECT_GT(world.nearest({3.5, 0.5})->distance, 0.0) << "101 is unknown";
}

TEST_F(MapFiles, PicturesAreReadAlikeAsPngAndPgm) {
  for (const std::string& bytes : {small_pgm, small_png, std::string("P2\n3 2\n100\n100 100 100\n0 80#grey\n100\n")}) {
    const map_file::Image image = map_file::parse_image(bytes);
    ASSERT_EQ(image.columns, 3);
    ASSERT_EQ(image.rows, 2);
    EXPECT_EQ(image.pixels[0].shade, 255);
    EXPECT_EQ(image.pixels[3].shade, 0);
    EXPECT_NEAR(image.pixels[4].shade, 205, 1);
    EXPECT_EQ(image.pixels[4].opacity, 255);
  }
  const map_file::Image wide = map_file::parse_image(std::string("P5 2 1 65535\n") + "\xff\xff" + std::string(2, '\0'));
  EXPECT_EQ(wide.pixels[0].shade, 255);
  EXPECT_EQ(wide.pixels[1].shade, 0);
}

TEST_F(MapFiles, AWorldHoldsShapesPicturesAndMapsTogether) {
  write("m.pgm", small_pgm);
  write("m.png", small_png);
  write("office.yaml", ros);
  write("floor.map", "2D-Map\nLINES\n5000 0 5000 1000\nDATA\n");
  const World world = load_world(write("world.yaml",
                                       "kervan_world: 1\n"
                                       "name: both\n"
                                       "segments:\n"
                                       "  - [[7 m, 0 m], [7 m, 1 m]]\n"
                                       "bitmaps:\n"
                                       "  - {image: m.png, center: [20 m, 0 m], size: [3 m, 4 m], yaw: 0 deg}\n"
                                       "maps: [office.yaml, floor.map]\n"));
  EXPECT_NEAR(ray_right(world, {0.0, -1.75}), 1.0, 1e-6) << "the map of ROS";
  EXPECT_NEAR(ray_right(world, {4.0, 0.5}), 1.0, 1e-12) << "the map of ARIA";
  EXPECT_NEAR(ray_right(world, {6.0, 0.5}), 1.0, 1e-12) << "the world's own wall";
  EXPECT_NEAR(ray_right(world, {15.0, -1.0}), 3.5, 1e-6) << "the picture's lower left pixel, 1 m x 2 m";
  EXPECT_EQ(world.bitmaps().size(), 2u);
}

TEST_F(MapFiles, EveryMistakeInAMapOfRosIsNamedAtItsPlace) {
  write("m.pgm", small_pgm);
  write("note.png", "this is no picture");
  write("cut.png", small_png.substr(0, 50));
  write("cut.pgm", small_pgm.substr(0, small_pgm.size() - 2));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = ros + "occupied_thresh: 0.65\n";
    text.replace(text.find(from), from.size(), to);
    return refusal("r.yaml", text);
  };
  EXPECT_EQ(with("resolution: 0.5\n", ""), "r.yaml:1:1: the key 'resolution' is missing");
  EXPECT_EQ(with("0.5", "0"),
            "r.yaml:2:13: resolution: 0 is out of range; allowed: above 0, at most 1000 (metres per pixel)");
  EXPECT_EQ(with("0.5", "5 cm"), "r.yaml:2:13: resolution: '5 cm' has a unit, but this is a plain number; write 5");
  EXPECT_EQ(with("origin: [1.0, -2.0, 0.0]\n", ""), "r.yaml:1:1: the key 'origin' is missing");
  EXPECT_EQ(with("[1.0, -2.0, 0.0]", "[1.0, -2.0]"),
            "r.yaml:3:9: origin: expected the pose of the lower left corner [x, y, yaw], found a list of 2");
  EXPECT_EQ(with("-2.0", "-2e9"),
            "r.yaml:3:15: origin[1]: -2e9 is out of range; allowed: -1000000 .. 1000000 (metres)");
  EXPECT_EQ(with("0.0]", "90]"),
            "r.yaml:3:21: origin[2]: 90 is out of range; allowed: -6.2831853 .. 6.2831853 (radians)");
  EXPECT_EQ(with("0.0]", ".nan]"), "r.yaml:3:21: origin[2]: '.nan' is not a number");
  EXPECT_EQ(with("0.65", "65"), "r.yaml:4:18: occupied_thresh: 65 is out of range; allowed: 0 .. 1");
  EXPECT_EQ(with("0.65\n", "0.1\nfree_thresh: 0.2\n"),
            "r.yaml:5:14: free_thresh: the free threshold is above occupied_thresh (0.1)");
  EXPECT_EQ(with("0.65\n", "0.65\nmode: grey\n"), "r.yaml:5:7: mode: grey is not one of trinary, scale, raw");
  EXPECT_EQ(with("0.65\n", "0.65\nnegate: 2\n"), "r.yaml:5:9: negate: 2 is not one of 0, 1, false, true");
  EXPECT_EQ(with("0.65\n", "0.65\nunits: m\n"),
            "r.yaml:5:1: unknown key 'units'; allowed: image, resolution, origin, negate, occupied_thresh, "
            "free_thresh, mode");
  EXPECT_EQ(with("m.pgm", "gone.pgm"), "r.yaml:1:8: image: gone.pgm: cannot read the file: No such file or directory");
  EXPECT_EQ(with("m.pgm", "note.png"), "r.yaml:1:8: image: note.png: neither a PNG nor a PGM (P2, P5) picture");
  EXPECT_EQ(with("m.pgm", "cut.png"), "r.yaml:1:8: image: cut.png: not a readable PNG: read beyond end of data");
  EXPECT_EQ(with("m.pgm", "cut.pgm"), "r.yaml:1:8: image: cut.pgm: not a readable PGM: it has 4 of 6 pixels");
  write("none.pgm", "P5\n0 7\n255\n");
  EXPECT_EQ(with("m.pgm", "none.pgm"), "r.yaml:1:8: image: none.pgm: the picture has no pixels");
  write("huge.pgm", "P5\n90000 90000\n255\n");
  EXPECT_EQ(with("m.pgm", "huge.pgm"),
            "r.yaml:1:8: image: huge.pgm: the picture has 90000 x 90000 pixels; allowed: 100000000");
  write("odd.pgm", "P5\nwide 7\n255\n");
  EXPECT_EQ(with("m.pgm", "odd.pgm"), "r.yaml:1:8: image: odd.pgm: not a readable PGM: the width is missing");
}

TEST_F(MapFiles, EveryMistakeWithMapsAndPicturesOfAWorldIsNamedAtItsPlace) {
  write("note.png", "this is no picture");
  const auto with = [&](const std::string& lines) { return refusal("w.yaml", "kervan_world: 1\nname: w\n" + lines); };
  EXPECT_EQ(with("maps: [gone.yaml]\n"),
            "w.yaml:3:8: maps[0]: gone.yaml: cannot read the file: No such file or directory");
  EXPECT_EQ(with("bitmaps:\n  - {image: note.png, center: [0 m, 0 m], size: [1 m, 1 m]}\n"),
            "w.yaml:4:13: image: note.png: neither a PNG nor a PGM (P2, P5) picture");
  EXPECT_EQ(with("bitmaps:\n  - {image: note.png, center: [0 m, 0 m], size: [1 m]}\n"),
            "w.yaml:4:49: size: expected two extents [along x m, along y m], found a list of 1");
  EXPECT_EQ(with("bitmaps:\n  - {image: note.png, center: [0 m, 0 m]}\n"),
            "w.yaml:4:5: bitmaps[0]: the key 'size' is missing");
}

TEST_F(MapFiles, AMapOfAriaGivesItsLinesAndPoints) {
  const Obstacles map = parse_aria_map(
      "2D-Map\r\n"
      "NumPoints: 3\n"
      "Resolution: 20\n"
      "NumLines: 1\n"
      "MapInfo: GoalType Name=Goal\n"
      "Cairn: Goal -3196 4846 0.000000 \"\" ICON \"Goal 1\"\n"
      "LINES\n"
      "-4756 7542 -4756 3523\n"
      "DATA\n"
      "100 40\n"
      "140 40\n"
      "100 60\n",
      "a.map");
  ASSERT_EQ(map.segments.size(), 1u);
  EXPECT_EQ(map.segments[0].a, Vector2(-4.756, 7.542));
  ASSERT_EQ(map.bitmaps.size(), 1u);
  const Bitmap& points = map.bitmaps[0];
  EXPECT_EQ(points.columns, 3);
  EXPECT_EQ(points.rows, 2);
  EXPECT_NEAR(points.origin.x, 0.09, 1e-12);
  EXPECT_NEAR(points.origin.y, 0.03, 1e-12);
  EXPECT_EQ(points.solid, (std::vector<std::uint8_t>{1, 0, 1, 1, 0, 0}));
}

TEST_F(MapFiles, EveryMistakeInAMapOfAriaIsNamedAtItsLine) {
  const auto of = [&](const std::string& text) { return refusal("a.map", text); };
  EXPECT_EQ(of(""), "a.map:1:1: not a map of ARIA: the first line must be 2D-Map");
  EXPECT_EQ(of("type octile\n"), "a.map:1:1: not a map of ARIA: the first line must be 2D-Map");
  EXPECT_EQ(of("2D-Map\nLINES\n1 2 3\n"), "a.map:3:1: '1 2 3' is not the ends of a line: x1 y1 x2 y2, in mm");
  EXPECT_EQ(of("2D-Map\nLINES\n1 2 3 4 5\n"), "a.map:3:1: '1 2 3 4 5' is not the ends of a line: x1 y1 x2 y2, in mm");
  EXPECT_EQ(of("2D-Map\nLINES\n1 2 1 2\n"), "a.map:3:1: both ends of the line are the same point");
  EXPECT_EQ(of("2D-Map\nResolution: 20\nDATA\n1 x\n"), "a.map:4:1: '1 x' is not a point: x y, in mm");
  EXPECT_EQ(of("2D-Map\nDATA\n1 2\n"), "a.map:1:1: a map with points needs a Resolution");
  EXPECT_EQ(of("2D-Map\nResolution: 0\nDATA\n1 2\n"), "a.map:2:1: the resolution must be above 0 mm");
  EXPECT_EQ(of("2D-Map\nNumLines: 2\nLINES\n1 2 3 4\n"), "a.map:2:1: NumLines: 2 lines are announced, the file has 1");
  EXPECT_EQ(of("2D-Map\nNumPoints: 1\n"), "a.map:2:1: NumPoints: 1 points are announced, the file has 0");
  EXPECT_EQ(of("2D-Map\nNumLines\n"), "a.map:2:1: 'NumLines' is no line of a map's header; expected KEY: VALUE");
  EXPECT_EQ(of("2D-Map\nLINES\n1 2 3 4e99\n"), "a.map:3:1: '1 2 3 4e99' is out of range; allowed: 1000 km");
  EXPECT_EQ(of("2D-Map\nResolution: 1\nDATA\n0 0\n900000000 900000000\n"),
            "a.map:2:1: the points lie too far from each other for this resolution: 9e+08 x 9e+08 cells; allowed: "
            "100000000");
  EXPECT_EQ(refused([] { load_world("no/such.map"); }), "no/such.map: cannot read the file: No such file or directory");
}

}  // namespace
}  // namespace kervan::sim
