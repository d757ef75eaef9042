// Maps that others made: every one loads, and what World says at random places is what brute force says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include "sim/files/world_file.hpp"

namespace kervan::sim {
namespace {

namespace fs = std::filesystem;

constexpr double pi = std::numbers::pi;

fs::path data_folder() {
  if (const char* given = std::getenv("KERVAN_TEST_DATA")) return given;
  return fs::path(KERVAN_SIM_FOLDER).parent_path() / "../shared/data";
}

#define SKIP_WITHOUT_TEST_DATA()  \
  if (!fs::exists(data_folder())) \
  GTEST_SKIP() << "there are no test data in " << data_folder() << "; KERVAN_TEST_DATA may name another folder"

/// Where to look: the box around everything.
struct Extent {
  Vector2 low = Vector2::Constant(infinity);
  Vector2 high = Vector2::Constant(-infinity);

  void grow(const Vector2& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
};

Extent extent(const World& world) {
  Extent all;
  const auto grow = [&](std::span<const Segment> segments) {
    for (const Segment& s : segments) {
      all.grow(s.a);
      all.grow(s.b);
    }
  };
  grow(world.segments());
  for (const CellMap& map : world.bitmaps()) grow(map.edges().segments());
  for (const Circle& c : world.circles()) all.grow(c.center);
  return all;
}

/// Asks at random places that are not solid, and compares with every edge, segment and disc.
void expect_as_brute_force(const World& world, int places) {
  const Extent all = extent(world);
  ASSERT_TRUE((all.low.array() < all.high.array()).all()) << "nothing is in this world";
  std::vector<Segment> segments(world.segments().begin(), world.segments().end());
  for (const CellMap& map : world.bitmaps())
    segments.insert(segments.end(), map.edges().segments().begin(), map.edges().segments().end());

  std::mt19937 random(7);
  const auto number = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  int beside_a_corner = 0;
  for (int i = 0; i < places;) {
    const Vector2 point(number(all.low.x(), all.high.x()), number(all.low.y(), all.high.y()));
    const Ray ray{point, geometry::heading(number(-pi, pi))};
    const auto nearest = world.nearest(point);
    ASSERT_TRUE(nearest);
    if (nearest->distance == 0.0) continue;
    ++i;
    double squared = infinity, hit = infinity, slant = 1.0, to_disc = infinity;
    for (const Segment& s : segments) {
      squared = std::min(squared, (nearest_point(s, point) - point).squaredNorm());
      const double distance = hit_distance(ray, s);
      if (distance >= hit) continue;
      hit = distance;
      slant = std::abs(hit_normal(ray, s).dot(ray.direction));
    }
    for (const Circle& c : world.circles()) {
      to_disc = std::min(to_disc, (nearest_point(c, point) - point).norm());
      hit = std::min(hit, hit_distance(ray, c));
    }
    ASSERT_NEAR(nearest->distance, std::min(std::sqrt(squared), to_disc), 1e-9) << "at " << point.transpose();
    const auto found = world.cast(ray);
    const double distance = found ? found->distance : infinity;
    if (distance != hit && !(std::abs(distance - hit) <= 1e-6 * (hit + 1.0) / slant)) ++beside_a_corner;
  }
  EXPECT_LE(beside_a_corner, 1) << "of " << places << " rays";
}

TEST(ExternalMaps, TheMapsOfRosAreAsTheyLook) {
  SKIP_WITHOUT_TEST_DATA();
  const std::map<std::string, std::pair<int, Vector2>> maps = {{"willow-full-0.05", {13459, {58.25, 47.25}}},
                                                               {"tb3_sandbox", {870, {19.2, 19.2}}}};
  for (const auto& [name, facts] : maps) {
    SCOPED_TRACE(name);
    const World world = load_world((data_folder() / "ros" / (name + ".yaml")).string());
    ASSERT_EQ(world.bitmaps().size(), 1u);
    const SkipTables& cells = world.bitmaps()[0].cells();
    int solid = 0;
    for (int row = 0; row < cells.rows(); ++row)
      for (int column = 0; column < cells.columns(); ++column) solid += cells.blocked(column, row) ? 1 : 0;
    EXPECT_EQ(solid, facts.first);
    EXPECT_NEAR(cells.columns() * 0.05, facts.second.x(), 1e-9);
    EXPECT_NEAR(cells.rows() * 0.05, facts.second.y(), 1e-9);
    expect_as_brute_force(world, 1000);
  }
}

TEST(ExternalMaps, TheMapsOfAriaAreAsTheyLook) {
  SKIP_WITHOUT_TEST_DATA();
  const World columbia = load_world((data_folder() / "aria/columbia.map").string());
  EXPECT_EQ(columbia.segments().size(), 470u);
  ASSERT_EQ(columbia.bitmaps().size(), 1u);
  expect_as_brute_force(columbia, 1000);
  const World triangle = load_world((data_folder() / "aria/triangle.map").string());
  EXPECT_EQ(triangle.segments().size(), 9u);
  expect_as_brute_force(triangle, 1000);
}

TEST(ExternalMaps, TheBitmapsOfStageAreAsTheyLook) {
  SKIP_WITHOUT_TEST_DATA();
  const std::map<std::string, std::string> sizes = {{"cave.png", "[16 m, 16 m]"},
                                                    {"hospital_section.png", "[40 m, 18 m]"}};
  for (const auto& [file, size] : sizes) {
    SCOPED_TRACE(file);
    const std::string path = fs::absolute(data_folder() / "stage" / file).string();
    const World world = parse_world(
        "kervan_world: 1\nname: stage\nbitmaps:\n  - {image: '" + path + "', center: [0 m, 0 m], size: " + size + "}\n",
        "stage.yaml");
    expect_as_brute_force(world, 1000);
  }
}

/// Sets of many maps are checked in parts, which run side by side.
class ManyExternalMaps : public testing::TestWithParam<int> {};
constexpr int parts = 5;

TEST_P(ManyExternalMaps, TheGridsOfMovingAiAreAsTheyLook) {
  SKIP_WITHOUT_TEST_DATA();
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(data_folder() / "movingai/maps"))
    if (entry.path().extension() == ".map") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  ASSERT_EQ(files.size(), 9u);
  for (auto i = static_cast<std::size_t>(GetParam()); i < files.size(); i += parts) {
    SCOPED_TRACE(files[i]);
    std::ifstream file(files[i]);
    std::string word, row;
    Bitmap map;
    map.cell = {1.0, 1.0};
    file >> word >> word >> word >> map.rows >> word >> map.columns >> word;
    for (int y = 0; y < map.rows; ++y) {
      file >> row;
      ASSERT_EQ(row.size(), static_cast<std::size_t>(map.columns));
      std::vector<std::uint8_t> cells;
      for (const char c : row) cells.push_back(c == '.' || c == 'G' || c == 'S' ? 0 : 1);
      map.solid.insert(map.solid.begin(), cells.begin(), cells.end());  // the first row is the top
    }
    expect_as_brute_force(World({.bitmaps = {map}}), 1000);
  }
}

TEST_P(ManyExternalMaps, TheWorldsOfBarnAreAsTheyLook) {
  SKIP_WITHOUT_TEST_DATA();
  std::ifstream file(data_folder() / "barn/barn_cylinders.csv");
  std::string line;
  std::getline(file, line);
  std::map<int, Obstacles> worlds;
  while (std::getline(file, line)) {
    int world = 0;
    Circle rod{Vector2::Zero(), 0.0};
    ASSERT_EQ(std::sscanf(line.c_str(), "%d,%lf,%lf,%lf", &world, &rod.center.x(), &rod.center.y(), &rod.radius), 4);
    worlds[world].circles.push_back(rod);
  }
  EXPECT_EQ(worlds.size(), 150u);
  for (const auto& [number, obstacles] : worlds) {
    if (number / 2 % parts != GetParam()) continue;  // they have even numbers
    SCOPED_TRACE(number);
    expect_as_brute_force(World(obstacles), 1000);
  }
}

INSTANTIATE_TEST_SUITE_P(Parts, ManyExternalMaps, testing::Range(0, parts));

}  // namespace
}  // namespace kervan::sim
