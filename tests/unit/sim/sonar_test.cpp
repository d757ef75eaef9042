#include "sim/sonar.hpp"

#include <gtest/gtest.h>

#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

constexpr double degree = pi / 180.0;
const RandomSource source(1, "r1");

/// One sonar at the origin that looks along x.
SonarRing single() { return {.min_range = 0.15, .max_range = 5.0, .field_of_view = 30.0 * degree, .poses = {Pose2{}}}; }

double read(const World& world, const Pose2& pose, const SonarSettings& settings, std::uint64_t scan = 0) {
  double range = 0.0;
  Sonars(single(), settings).measure(world, pose, source, scan, {&range, 1});
  return range;
}

World wall_at(double x) { return World({.segments = {{{x, -50.0}, {x, 50.0}}}}); }

TEST(SonarRing, OfTheP3DxIsThatOfItsTable) {
  constexpr int table[16][3] = {{69, 136, 90},     {114, 119, 50},     {148, 78, 30},     {166, 27, 10},
                                {166, -27, -10},   {148, -78, -30},    {114, -119, -50},  {69, -136, -90},
                                {-157, -136, -90}, {-203, -119, -130}, {-237, -78, -150}, {-255, -27, -170},
                                {-255, 27, 170},   {-237, 78, 150},    {-203, 119, 130},  {-157, 136, 90}};
  const SonarRing& ring = p3dx().sonars;
  ASSERT_EQ(ring.poses.size(), 16u);
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_NEAR(ring.poses[i].x, 0.001 * table[i][0], 1e-12) << "sonar " << i;
    EXPECT_NEAR(ring.poses[i].y, 0.001 * table[i][1], 1e-12) << "sonar " << i;
    EXPECT_NEAR(ring.poses[i].yaw, degree * table[i][2], 1e-12) << "sonar " << i;
  }
  EXPECT_EQ(ring.min_range, 0.15);
  EXPECT_EQ(ring.max_range, 5.0);
  EXPECT_NEAR(ring.field_of_view, 30.0 * degree, 1e-12);
}

TEST(SonarRing, OfTheP3DxIsSymmetric) {
  const auto& poses = p3dx().sonars.poses;
  for (std::size_t i = 0; i < 8; ++i) {
    for (const auto& [left, right] : {std::pair{poses[i], poses[7 - i]}, std::pair{poses[15 - i], poses[8 + i]}}) {
      EXPECT_EQ(left.x, right.x);
      EXPECT_EQ(left.y, -right.y);
      EXPECT_EQ(left.yaw, -right.yaw);
    }
  }
}

TEST(SonarRing, OfTheP3DxSitsWithinItsBody) {
  for (const Pose2& pose : p3dx().sonars.poses) EXPECT_TRUE(p3dx().outline.contains(pose.position()));
}

TEST(Sonar, ASingleRayLooksAlongTheAxisOnly) {
  EXPECT_NEAR(read(wall_at(2.0), {0.0, 0.0, 0.5}, {.rays = 1, .noise = 0.0}), 2.0 / std::cos(0.5), 1e-12);
  const World rod({.circles = {{{2.0, 0.2}, 0.05}}});
  EXPECT_EQ(read(rod, {}, {.rays = 1, .noise = 0.0}), infinity);
  EXPECT_NEAR(read(rod, {}, {.rays = 32, .noise = 0.0}), std::hypot(2.0, 0.2) - 0.05, 2e-3);
}

TEST(Sonar, WithoutAnEchoTheRangeIsInfinite) {
  EXPECT_EQ(read(World({}), {}, {}), infinity);
  EXPECT_EQ(read(wall_at(5.3), {}, {.noise = 0.0}), infinity);
  EXPECT_TRUE(std::isfinite(read(wall_at(4.9), {}, {.noise = 0.0})));
}

TEST(Sonar, AnEchoBelowTheMinimumIsReportedAtTheMinimum) { EXPECT_EQ(read(wall_at(0.05), {}, {}), 0.15); }

TEST(Sonar, NoiseIsAShareOfTheDistance) {
  const World world = wall_at(2.0);
  double sum = 0.0, squares = 0.0;
  constexpr int count = 4000;
  for (std::uint64_t scan = 0; scan < count; ++scan) {
    const double error = read(world, {}, {.rays = 1, .noise = 0.01}, scan) / 2.0 - 1.0;
    sum += error;
    squares += error * error;
  }
  EXPECT_NEAR(sum / count, 0.0, 5 * 0.01 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), 0.01, 5 * 0.01 / std::sqrt(2.0 * count));
}

TEST(Sonar, DropOutsComeAsOftenAsAskedAndChangeNothingElse) {
  const World world = wall_at(2.0);
  int lost = 0;
  constexpr int count = 4000;
  for (std::uint64_t scan = 0; scan < count; ++scan) {
    const double range = read(world, {}, {.rays = 1, .drop_out = 0.1}, scan);
    if (range == infinity)
      ++lost;
    else
      EXPECT_EQ(range, read(world, {}, {.rays = 1}, scan));
  }
  EXPECT_NEAR(lost, 0.1 * count, 5 * std::sqrt(0.1 * 0.9 * count));
}

TEST(Sonar, RefusesSettingsOutOfRange) {
  EXPECT_THROW(Sonars(single(), {.rays = 0}), std::invalid_argument);
  EXPECT_THROW(Sonars(single(), {.noise = -0.1}), std::invalid_argument);
  EXPECT_THROW(Sonars(single(), {.drop_out = 1.1}), std::invalid_argument);
  EXPECT_THROW(Sonars(single(), {.crosstalk = -0.1}), std::invalid_argument);
  EXPECT_THROW(Sonars(single(), {.incidence_drop_off = 0.1}), std::invalid_argument) << "without a limit";
  EXPECT_THROW(Sonars(single(), {.incidence_limit = 0.1, .incidence_drop_off = 0.2}), std::invalid_argument);
}

}  // namespace
}  // namespace kervan::sim
