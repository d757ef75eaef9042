#include "sim/bitmap.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "sim/simulation.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

/// Rows of text from the top, as one looks at a map; '#' is solid.
Bitmap drawn(const std::vector<std::string>& rows, Pose2 origin, Vector2 cell) {
  Bitmap map{origin, cell, static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), {}};
  for (auto row = rows.rbegin(); row != rows.rend(); ++row)
    for (const char c : *row) map.solid.push_back(c == '#' ? 1 : 0);
  return map;
}

Outline square(double half) { return Outline({{half, -half}, {half, half}, {-half, half}, {-half, -half}}); }

double distance(const World& world, Vector2 origin, double yaw, double range = infinity) {
  const auto hit = world.cast({origin, geometry::heading(yaw)}, range);
  return hit ? hit->distance : infinity;
}

TEST(Bitmap, RaysMeetTheEdgesOfItsCells) {
  const World world({.bitmaps = {drawn({"...#",  //
                                        "....",  //
                                        "#..."},
                                       {10.0, 20.0, 0.0}, {0.5, 0.25})}});
  EXPECT_NEAR(distance(world, {10.25, 20.6}, 0.0), 1.25, 1e-6);
  EXPECT_NEAR(distance(world, {10.25, 20.6}, -0.5 * pi), 0.35, 1e-6);
  EXPECT_EQ(distance(world, {10.25, 20.3}, 0.0), infinity) << "between the rows of solid cells";
  EXPECT_EQ(distance(world, {10.25, 20.1}, 1.0), 0.0) << "within a solid cell";
  EXPECT_EQ(distance(world, {10.25, 20.6}, 0.0, 1.2), infinity) << "beyond the range";
  const auto hit = world.cast({{10.25, 20.6}, {1.0, 0.0}});
  EXPECT_EQ(hit->normal, Vector2(-1.0, 0.0));
}

TEST(Bitmap, RaysFromOutsideComeIn) {
  const World world({.bitmaps = {drawn({"...",  //
                                        ".#.",  //
                                        "..."},
                                       {}, {1.0, 1.0})}});
  EXPECT_NEAR(distance(world, {-5.0, 1.5}, 0.0), 6.0, 1e-6);
  EXPECT_NEAR(distance(world, {1.5, 9.0}, -0.5 * pi), 7.0, 1e-6);
  EXPECT_EQ(distance(world, {-5.0, 1.5}, pi), infinity);
  EXPECT_EQ(distance(world, {-5.0, 3.5}, 0.0), infinity);
  EXPECT_EQ(distance(world, {-5.0, 1.5}, 0.0, 5.9), infinity);
  const World full({.bitmaps = {drawn({"#"}, {}, {1.0, 1.0})}});
  EXPECT_EQ(full.cast({{-5.0, 0.5}, {1.0, 0.0}})->normal, Vector2(-1.0, 0.0)) << "met at the raster's own border";
  EXPECT_NEAR(distance(full, {-5.0, 0.5}, 0.0), 5.0, 1e-6);
}

TEST(Bitmap, MayBeTurned) {
  const World world({.bitmaps = {drawn({"..#"}, {0.0, 0.0, 0.5 * pi}, {1.0, 1.0})}});  // columns run along +y
  EXPECT_NEAR(distance(world, {-0.5, 0.5}, 0.5 * pi), 1.5, 1e-6);
  const auto hit = world.cast({{-0.5, 0.5}, {0.0, 1.0}});
  EXPECT_NEAR(hit->normal.y(), -1.0, 1e-12);
}

TEST(Bitmap, LivesBesideShapesInOneWorld) {
  const World world(
      {.segments = {{{1.0, -9.0}, {1.0, 9.0}}},
       .circles = {{{3.0, 7.5}, 0.5}},
       .bitmaps = {drawn({"#"}, {4.0, 0.0, 0.0}, {1.0, 1.0}), drawn({"#"}, {3.0, 0.0, 0.0}, {0.1, 0.1})}});
  EXPECT_DOUBLE_EQ(distance(world, {0.0, 0.05}, 0.0), 1.0);
  EXPECT_NEAR(distance(world, {2.0, 0.5}, 0.0), 2.0, 1e-6);
  EXPECT_NEAR(distance(world, {2.0, 0.05}, 0.0), 1.0, 1e-6);
  EXPECT_NEAR(world.nearest({3.9, 0.5})->distance, 0.1, 1e-12);
  EXPECT_NEAR(world.nearest({1.1, 0.5})->distance, 0.1, 1e-12);
  EXPECT_EQ(world.nearest({4.5, 0.5})->distance, 0.0);
  EXPECT_EQ(world.clearance(square(0.2), {4.5, 0.5, 0.3}).distance, 0.0) << "the body within a cell";
  EXPECT_EQ(world.clearance(square(0.2), {3.05, 0.05, 0.3}).distance, 0.0) << "a cell within the body";
  EXPECT_NEAR(world.clearance(square(0.2), {3.7, 0.5, 0.0}).distance, 0.1, 1e-12);
}

TEST(Bitmap, ItsOuterEdgesRunAsFarAsTheyAreStraight) {
  const auto edges = outer_edges(drawn({".##.",  //
                                        ".#.."},
                                       {1.0, 2.0, 0.0}, {0.5, 0.25}));
  EXPECT_EQ(edges.size(), 6u);
  double length = 0.0;
  for (const Segment& edge : edges) length += (edge.b - edge.a).norm();
  EXPECT_NEAR(length, 2 * 1.0 + 2 * 0.5, 1e-12);
}

TEST(Bitmap, RefusesWhatCannotBe) {
  EXPECT_THROW(World({.bitmaps = {Bitmap{{}, {0.1, 0.1}, 2, 2, {0, 0, 0}}}}), std::invalid_argument);
  EXPECT_THROW(World({.bitmaps = {Bitmap{{}, {0.0, 0.1}, 1, 1, {0}}}}), std::invalid_argument);
  EXPECT_THROW(World({.bitmaps = {Bitmap{{}, {0.1, 0.1}, 0, 0, {}}}}), std::invalid_argument);
  EXPECT_THROW(World({.bitmaps = {Bitmap{{0.0, std::nan(""), 0.0}, {0.1, 0.1}, 1, 1, {0}}}}), std::invalid_argument);
}

TEST(Bitmap, ARobotIsStoppedByItsCellsAndNeverEntersThem) {
  // A wall one cell of a centimetre thick, turned, and a robot at full speed with steps of half a second.
  std::vector<std::string> rows(400, std::string(400, '.'));
  for (auto& row : rows) row[300] = '#';
  const Pose2 frame{1.0, -2.0, 0.3};
  const auto world = std::make_shared<const World>(Obstacles{.bitmaps = {drawn(rows, frame, {0.01, 0.01})}});
  RobotSetup setup = perfect("r1", frame * Pose2{0.5, 2.0, 0.0});
  setup.command_timeout = 10s;
  Simulation simulation(world, {setup}, 1);
  for (int i = 0; i < 20; ++i) {
    simulation.command(0, {1.0, 0.0});
    simulation.step(500ms);
    EXPECT_GT(world->clearance(p3dx().outline, simulation.robots()[0].pose()).distance, 0.0);
  }
  const Pose2 end = frame.inverse() * simulation.robots()[0].pose();
  EXPECT_NEAR(end.x, 3.0 - 0.211, 1e-5);
  EXPECT_EQ(simulation.robots()[0].body().contacts(), 1u);
}

/// Random rasters, turned and with oblong cells, against brute force over every cell.
class RandomBitmap : public testing::TestWithParam<unsigned> {
 protected:
  RandomBitmap() : random_(GetParam()) {
    const double density = GetParam() % 3 == 0 ? 0.3 : 0.02;
    map_ = {
        {number(-5.0, 5.0), number(-5.0, 5.0), number(-pi, pi)}, {number(0.05, 0.2), number(0.05, 0.2)}, 53, 37, {}};
    if (GetParam() % 2 == 0) map_.origin.yaw = 0.0;
    for (int i = 0; i < map_.columns * map_.rows; ++i) map_.solid.push_back(number(0.0, 1.0) < density ? 1 : 0);
    for (int row = 0; row < map_.rows; ++row)
      for (int column = 0; column < map_.columns; ++column)
        if (map_.is_solid(column, row))
          boxes_.push_back(
              {map_.origin * Pose2{(column + 0.5) * map_.cell.x(), (row + 0.5) * map_.cell.y(), 0.0}, map_.cell});
  }

  double number(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }

  /// A point on the raster, or as far beyond it as `margin` says, as a share of its extent.
  Vector2 point(double margin) {
    return map_.origin * Vector2(number(-margin, 1.0 + margin) * map_.columns * map_.cell.x(),
                                 number(-margin, 1.0 + margin) * map_.rows * map_.cell.y());
  }

  double nearest_hit(const Ray& ray) const {
    double best = infinity;
    for (const Box& box : boxes_) {
      if (contains(box, ray.origin)) return 0.0;
      const auto c = corners(box);
      for (std::size_t i = 0; i < 4; ++i) best = std::min(best, hit_distance(ray, Segment{c[i], c[(i + 1) % 4]}));
    }
    return best;
  }

  std::mt19937 random_;
  Bitmap map_;
  std::vector<Box> boxes_;  // one for each solid cell
};

TEST_P(RandomBitmap, TheTablesHoldTheLargestEmptySquares) {
  const SkipTables tables(map_.columns, map_.rows, map_.solid);
  for (int quadrant = 0; quadrant < 4; ++quadrant) {
    const bool left = (quadrant & 1) != 0, down = (quadrant & 2) != 0;
    const auto blocked = [&](int x, int y) {
      return x >= map_.columns || y >= map_.rows ||
             map_.is_solid(left ? map_.columns - 1 - x : x, down ? map_.rows - 1 - y : y);
    };
    for (int y = 0; y < map_.rows; ++y)
      for (int x = 0; x < map_.columns; ++x) {
        int side = 0;
        const auto empty = [&](int s) {
          for (int k = 0; k < s; ++k)
            if (blocked(x + s - 1, y + k) || blocked(x + k, y + s - 1)) return false;
          return true;
        };
        while (empty(side + 1)) ++side;
        ASSERT_EQ(tables.entry(quadrant, x, y), side) << quadrant << " " << x << " " << y;
      }
  }
}

TEST_P(RandomBitmap, TheClearanceFieldIsThatOfBruteForce) {
  const SkipTables tables(map_.columns, map_.rows, map_.solid);
  for (int row = 0; row < map_.rows; ++row)
    for (int column = 0; column < map_.columns; ++column) {
      int expected = std::min({column, row, map_.columns - 1 - column, map_.rows - 1 - row}) + 1;
      for (int y = 0; y < map_.rows; ++y)
        for (int x = 0; x < map_.columns; ++x)
          if (map_.is_solid(x, y)) expected = std::min(expected, std::max(std::abs(x - column), std::abs(y - row)));
      ASSERT_EQ(tables.free_around(column, row), expected);
    }
}

TEST_P(RandomBitmap, RaysMeetWhatBruteForceMeets) {
  const World world({.bitmaps = {map_}});
  for (int i = 0; i < 1000; ++i) {
    Ray ray{point(i % 4 == 0 ? 0.5 : 0.0), geometry::heading(number(-pi, pi))};
    if (i % 5 == 0) ray.direction = geometry::heading(map_.origin.yaw + 0.5 * pi * (i % 4));
    const double expected = nearest_hit(ray);
    const auto hit = world.cast(ray);
    const double found = hit ? hit->distance : infinity;
    if (found != expected) {
      // Single precision turns the ray by some 1e-7 rad, which matters the more the more obliquely it meets the edge.
      const double slant = hit ? std::abs(hit->normal.dot(ray.direction)) : 1.0;
      ASSERT_NEAR(found, expected, 1e-6 * (found + 0.1) / slant) << "ray " << i;
    }
    if (hit) {
      EXPECT_NEAR(hit->normal.norm(), 1.0, 1e-9);
      EXPECT_LE(hit->normal.dot(ray.direction), 1e-9);
    }
    const auto near = world.cast(ray, 1.0);
    if (std::abs(expected - 1.0) > 1e-5) {
      EXPECT_EQ(near.has_value(), expected <= 1.0) << "ray " << i;
    }
  }
}

TEST_P(RandomBitmap, EverySetOfInstructionsGivesTheSameBits) {
  const CellMap cells(map_);
  for (const Instructions instructions : {Instructions::avx2, Instructions::avx512}) {
    if (!available(instructions)) continue;
    for (const std::size_t count : {1, 7, 8, 15, 16, 17, 181, 600}) {
      std::vector<Vector2> directions;
      for (std::size_t i = 0; i < count; ++i)
        directions.push_back(geometry::heading(i % 5 == 0 ? 0.5 * pi * static_cast<double>(i % 4) : number(-pi, pi)));
      for (int i = 0; i < 50; ++i) {
        // One more at the end shows that nothing is written there.
        std::vector<float> expected(count + 1, -1.0f), found(count + 1, -1.0f);
        std::vector<std::int32_t> expected_faces(count + 1, -1), found_faces(count + 1, -1);
        const Vector2 origin = point(0.1);
        const std::size_t half = i % 2 == 0 ? 0 : count / 2;
        const std::array<RayFan, 2> fans{
            {{origin, {directions.data(), half}}, {point(0.1), {directions.data() + half, count - half}}}};
        const double range = number(0.1, 5.0);
        cells.cast(fans, range, {expected.data(), count}, {expected_faces.data(), count}, Instructions::scalar);
        cells.cast(fans, range, {found.data(), count}, {found_faces.data(), count}, instructions);
        ASSERT_EQ(found, expected) << count << " rays from " << origin.transpose();
        ASSERT_EQ(found_faces, expected_faces) << count << " rays from " << origin.transpose();
      }
    }
  }
}

TEST_P(RandomBitmap, NearestAndClearanceAreThoseOfBruteForce) {
  const World world({.bitmaps = {map_}});
  const World boxes({.boxes = boxes_});
  const Outline body({{0.211, -0.1}, {0.211, 0.1}, {-0.3, 0.2}, {-0.3, -0.2}});
  for (int i = 0; i < 200; ++i) {
    const Vector2 p = point(0.3);
    const Pose2 pose{p.x(), p.y(), number(-pi, pi)};
    EXPECT_NEAR(world.nearest(p)->distance, boxes.nearest(p)->distance, 1e-9);
    EXPECT_LE(world.free_around(p), world.nearest(p)->distance);
    const Clearance found = world.clearance(body, pose);
    EXPECT_NEAR(found.distance, boxes.clearance(body, pose).distance, 1e-9);
    EXPECT_NEAR((found.on_obstacle - found.on_outline).norm(), found.distance, 1e-9);
  }
}

TEST(FreeAround, ReachesNearlyToTheNextSolidCell) {
  Bitmap map{{-1.0, -2.0, 0.0}, Vector2::Constant(0.1), 60, 60, std::vector<std::uint8_t>(3600)};
  map.solid[30 * 60 + 50] = 1;  // from (4.0, 1.0) to (4.1, 1.1)
  const World world({.bitmaps = {map}});
  EXPECT_NEAR(world.free_around({2.55, 1.05}), 1.4, 1e-9) << "a cell less than the 1.45 m to its edge";
  EXPECT_NEAR(world.free_around({-0.95, 1.05}), 0.0, 1e-9) << "beside the border";
  EXPECT_EQ(world.free_around({4.05, 1.05}), 0.0);
  EXPECT_EQ(world.free_around({9.0, 9.0}), 0.0) << "outside nothing is known";
  EXPECT_EQ(World({.segments = {{{0.0, 0.0}, {1.0, 0.0}}}, .bitmaps = {map}}).free_around({2.55, 1.05}), 0.0);
  EXPECT_EQ(World({}).free_around({0.0, 0.0}), infinity);
}

TEST(Rays, TooManyAtOnceAreRefused) {
  const std::vector<Vector2> directions(most_rays + 1, Vector2(1.0, 0.0));
  const RayFan fan{Vector2::Zero(), directions};
  std::vector<RayHit> hits(directions.size());
  EXPECT_THROW(World({}).cast({&fan, 1}, 1.0, hits), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomBitmap, testing::Range(0u, 8u));

}  // namespace
}  // namespace kervan::sim
