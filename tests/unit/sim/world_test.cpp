#include "sim/world.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace kervan::sim {
namespace {

constexpr double pi = std::numbers::pi;

Ray ray(double x, double y, double yaw) { return {{x, y}, geometry::heading(yaw)}; }

Outline square(double half) { return Outline({{half, -half}, {half, half}, {-half, half}, {-half, -half}}); }

TEST(World, ARayMeetsAWallWhereGeometrySays) {
  const World world({.segments = {{{2.0, -10.0}, {2.0, 10.0}}}});
  for (const double yaw : {0.0, 0.3, -0.9, 1.3}) {
    const auto hit = world.cast(ray(0.5, 0.25, yaw));
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance, 1.5 / std::cos(yaw), 1e-12);
    EXPECT_NEAR(hit->normal.x(), -1.0, 1e-12);
    EXPECT_NEAR(hit->normal.y(), 0.0, 1e-12);
  }
  EXPECT_FALSE(world.cast(ray(0.5, 0.25, pi)));
  EXPECT_FALSE(world.cast(ray(0.5, 0.25, 0.5 * pi)));
}

TEST(World, TheNormalIsOnTheSideTheRayComesFrom) {
  const World world({.segments = {{{2.0, -10.0}, {2.0, 10.0}}}});
  EXPECT_NEAR(world.cast(ray(4.0, 0.0, pi))->normal.x(), 1.0, 1e-12);
}

TEST(World, ARayMeetsADiscWhereGeometrySays) {
  const World world({.circles = {{{5.0, 0.0}, 0.3}}});
  const auto front = world.cast(ray(0.0, 0.0, 0.0));
  ASSERT_TRUE(front);
  EXPECT_NEAR(front->distance, 4.7, 1e-12);
  EXPECT_NEAR(front->normal.x(), -1.0, 1e-12);
  const auto off_center = world.cast(ray(0.0, 0.18, 0.0));
  ASSERT_TRUE(off_center);
  EXPECT_NEAR(off_center->distance, 5.0 - 0.24, 1e-12);
  EXPECT_NEAR(off_center->normal.y(), 0.6, 1e-12);
  EXPECT_FALSE(world.cast(ray(0.0, 0.31, 0.0)));
  EXPECT_EQ(world.cast(ray(5.1, 0.1, 1.0))->distance, 0.0);
}

TEST(World, ABoxIsMetAtItsTurnedEdges) {
  const World world({.boxes = {{{3.0, 0.0, 0.25 * pi}, {std::sqrt(2.0), std::sqrt(2.0)}}}});  // corners at 3 ± 1
  EXPECT_NEAR(world.cast(ray(0.0, 0.5, 0.0))->distance, 2.5, 1e-12);
  EXPECT_NEAR(world.cast(ray(0.0, 0.0, 0.0))->distance, 2.0, 1e-9);
  EXPECT_NEAR(world.cast(ray(3.0, 9.0, -0.5 * pi))->distance, 8.0, 1e-9);
}

TEST(World, ARayAlongAWallMeetsItsEnd) {
  const World world({.segments = {{{2.0, 0.0}, {4.0, 0.0}}}});
  EXPECT_DOUBLE_EQ(world.cast(ray(0.0, 0.0, 0.0))->distance, 2.0);
  EXPECT_EQ(world.cast(ray(3.0, 0.0, 0.0))->distance, 0.0);
  EXPECT_FALSE(world.cast(ray(5.0, 0.0, 0.0)));
}

TEST(World, NothingIsSeenBeyondTheRange) {
  const World world({.segments = {{{2.0, -1.0}, {2.0, 1.0}}}});
  EXPECT_TRUE(world.cast(ray(0.0, 0.0, 0.0), 2.0));
  EXPECT_FALSE(world.cast(ray(0.0, 0.0, 0.0), 1.999));
}

TEST(World, NoRaySlipsThroughWhereTwoWallsMeet) {
  const Vector2 corner(10.0 / 3.0, 7.0 / 3.0);
  const World world({.segments = {{corner, {9.1, 5.3}}, {corner, {2.7, 8.9}}}});
  for (int i = 0; i < 20'000; ++i) {
    const Vector2 origin(0.001 * i - 10.0, -5.0 + 0.0003 * i);
    const Vector2 direction = (corner - origin).normalized();
    ASSERT_TRUE(world.cast({origin, direction})) << "from " << origin.transpose();
  }
}

TEST(World, AWorldWithoutObstaclesIsFreeEverywhere) {
  const World world({});
  EXPECT_FALSE(world.cast(ray(0.0, 0.0, 1.0)));
  EXPECT_FALSE(world.nearest({0.0, 0.0}));
  EXPECT_EQ(world.clearance(square(0.2), {}).distance, infinity);
}

TEST(World, TheNearestObstacleIsFoundFromNearAndFar) {
  const World world({.segments = {{{2.0, -1.0}, {2.0, 1.0}}}, .circles = {{{0.0, 3.0}, 0.5}}});
  const auto wall = world.nearest({0.5, 0.5});
  ASSERT_TRUE(wall);
  EXPECT_DOUBLE_EQ(wall->distance, 1.5);
  EXPECT_EQ(wall->point, Vector2(2.0, 0.5));
  EXPECT_NEAR(world.nearest({300.0, 1.0})->distance, 298.0, 1e-9);
  EXPECT_NEAR(world.nearest({-400.0, 3.0})->distance, 399.5, 1e-9);
  EXPECT_EQ(world.nearest({0.1, 3.1})->distance, 0.0);
  EXPECT_FALSE(world.nearest({0.5, 0.5}, 1.4));
}

TEST(World, ClearanceIsTheGapBetweenBodyAndObstacle) {
  const World world({.segments = {{{2.0, -1.0}, {2.0, 1.0}}}});
  const Clearance flat = world.clearance(square(0.2), {1.0, 0.0, 0.0});
  EXPECT_NEAR(flat.distance, 0.8, 1e-12);
  EXPECT_NEAR(flat.on_obstacle.x(), 2.0, 1e-12);
  EXPECT_NEAR(flat.on_outline.x(), 1.2, 1e-12);
  const Clearance corner = world.clearance(square(0.2), {1.0, 0.3, 0.25 * pi});
  EXPECT_NEAR(corner.distance, 1.0 - 0.2 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(corner.on_obstacle.y(), 0.3, 1e-12);
  const Clearance end = world.clearance(square(0.2), {2.0, 2.0, 0.0});
  EXPECT_NEAR(end.distance, 0.8, 1e-12);
}

TEST(World, ClearanceIsZeroWhenBodyAndObstacleOverlap) {
  const World world({.segments = {{{2.0, -1.0}, {2.0, 1.0}}},
                     .circles = {{{0.0, 3.0}, 0.05}, {{0.0, -9.0}, 3.0}},
                     .boxes = {{{-9.0, 0.0, 0.4}, {4.0, 4.0}}}});
  const Outline body = square(0.2);
  EXPECT_EQ(world.clearance(body, {1.9, 0.0, 0.0}).distance, 0.0) << "a wall across the body";
  EXPECT_EQ(world.clearance(body, {0.05, 3.05, 0.7}).distance, 0.0) << "a rod within the body";
  EXPECT_EQ(world.clearance(body, {0.0, -9.5, 0.0}).distance, 0.0) << "the body within a disc";
  EXPECT_EQ(world.clearance(body, {-9.5, 0.0, 0.0}).distance, 0.0) << "the body within a box";
  EXPECT_GT(world.clearance(body, {1.79, 0.0, 0.0}).distance, 0.0);
}

TEST(World, RefusesShapesWithoutExtent) {
  EXPECT_THROW(World({.segments = {{{1.0, 1.0}, {1.0, 1.0}}}}), std::invalid_argument);
  EXPECT_THROW(World({.circles = {{{1.0, 1.0}, 0.0}}}), std::invalid_argument);
  EXPECT_THROW(World({.circles = {{{std::nan(""), 1.0}, 1.0}}}), std::invalid_argument);
  EXPECT_THROW(World({.boxes = {{{}, {1.0, -1.0}}}}), std::invalid_argument);
}

TEST(Outline, RefusesWhatIsNotAConvexBodyAroundItsOrigin) {
  EXPECT_THROW(Outline({{1.0, 0.0}, {0.0, 1.0}}), std::invalid_argument);
  EXPECT_THROW(Outline({{-1.0, -1.0}, {-1.0, 1.0}, {1.0, 1.0}, {1.0, -1.0}}), std::invalid_argument) << "clockwise";
  EXPECT_THROW(Outline({{1.0, -1.0}, {0.1, 0.0}, {1.0, 1.0}, {-1.0, 0.0}}), std::invalid_argument) << "a notch";
  EXPECT_THROW(Outline({{2.0, -1.0}, {4.0, -1.0}, {4.0, 1.0}, {2.0, 1.0}}), std::invalid_argument) << "away from 0";
  std::vector<Vector2> star;
  for (int i = 0; i < 5; ++i) star.push_back(geometry::heading(0.8 * pi * i));
  EXPECT_THROW(Outline{star}, std::invalid_argument);
}

/// Random worlds: the grid must find exactly what asking every shape finds.
class RandomWorld : public testing::TestWithParam<unsigned> {
 protected:
  RandomWorld() : random_(GetParam()) {
    const double size = GetParam() % 2 == 0 ? 8.0 : 60.0;
    for (int i = 0; i < 40; ++i) obstacles_.segments.push_back({point(size), point(size)});
    for (int i = 0; i < 40; ++i) {
      const Vector2 a = point(size);
      obstacles_.segments.push_back({a, a + point(0.7)});
    }
    for (int i = 0; i < 20; ++i) obstacles_.circles.push_back({point(size), number(0.01, 1.0)});
    size_ = 1.3 * size;
  }

  double number(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  Vector2 point(double size) { return {number(-size, size), number(-size, size)}; }

  std::mt19937 random_;
  Obstacles obstacles_;
  double size_ = 0.0;
};

TEST_P(RandomWorld, RaysMeetWhatBruteForceMeets) {
  const World world(obstacles_);
  for (int i = 0; i < 2000; ++i) {
    // Some rays start on the borders of cells and run along them.
    Ray r = ray(number(-size_, size_), number(-size_, size_), number(-pi, pi));
    if (i % 5 == 0) r.direction = geometry::heading(0.5 * pi * (i % 4));
    if (i % 7 == 0) r.origin = obstacles_.segments[static_cast<std::size_t>(i % 80)].a;
    double expected = infinity;
    for (const Segment& s : obstacles_.segments) expected = std::min(expected, hit_distance(r, s));
    for (const Circle& c : obstacles_.circles) expected = std::min(expected, hit_distance(r, c));
    const auto hit = world.cast(r);
    ASSERT_EQ(hit ? hit->distance : infinity, expected) << "ray " << i;
    if (hit) {
      EXPECT_NEAR(hit->normal.norm(), 1.0, 1e-9);
      EXPECT_LE(hit->normal.dot(r.direction), 1e-9);
    }
    const auto near = world.cast(r, 5.0);
    ASSERT_EQ(near ? near->distance : infinity, expected <= 5.0 ? expected : infinity) << "ray " << i;
  }
}

TEST_P(RandomWorld, NearestAndClearanceAreThoseOfBruteForce) {
  const World world(obstacles_);
  const Outline body({{0.211, -0.1}, {0.211, 0.1}, {-0.3, 0.2}, {-0.3, -0.2}});
  for (int i = 0; i < 500; ++i) {
    const Pose2 pose{number(-size_, size_), number(-size_, size_), number(-pi, pi)};
    const Vector2 p = pose.position();
    const Pose2 back = pose.inverse();
    double distance = infinity, clearance = infinity;
    for (const Segment& s : obstacles_.segments) {
      distance = std::min(distance, (nearest_point(s, p) - p).norm());
      clearance = std::min(clearance, body.clearance(Segment{back * s.a, back * s.b}).distance);
    }
    for (const Circle& c : obstacles_.circles) {
      distance = std::min(distance, (nearest_point(c, p) - p).norm());
      clearance = std::min(clearance, body.clearance(Circle{back * c.center, c.radius}).distance);
    }
    EXPECT_NEAR(world.nearest(p)->distance, distance, 1e-12);
    const Clearance found = world.clearance(body, pose);
    EXPECT_NEAR(found.distance, clearance, 1e-9);
    EXPECT_NEAR((found.on_obstacle - found.on_outline).norm(), found.distance, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomWorld, testing::Range(0u, 8u));

}  // namespace
}  // namespace kervan::sim
