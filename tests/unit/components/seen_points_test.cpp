#include "components/control/seen_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace kervan::control {
namespace {

using namespace std::chrono_literals;
using geometry::Pose2;
using geometry::Vector2;

constexpr double pi = std::numbers::pi;
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

Time at(Duration time) { return Time(time); }

/// 271 beams over 270 degrees, a degree apart, that all measure the same.
struct Sweep {
  explicit Sweep(float range) : ranges(271, range) {}

  float& beam(int degrees) { return ranges[static_cast<std::size_t>(degrees + 135)]; }
  geometry::Scan scan() const { return {-0.75 * pi, pi / 180.0, 0.1, 8.0, ranges}; }

  std::vector<float> ranges;
};

bool has_point_at(const SeenPoints& seen, const Vector2& where) {
  const auto points = seen.points();
  return std::any_of(points.begin(), points.end(),
                     [&](const SeenPoints::Point& point) { return (point.at - where).norm() < 0.01; });
}

TEST(SeenPoints, EchoesStandInTheFrameOfTheOdometry) {
  SeenPoints seen({});
  Sweep sweep(infinity);
  sweep.beam(90) = 1.5f;
  seen.look({2.0, 1.0, pi / 2}, sweep.scan(), at(0s));
  ASSERT_EQ(seen.points().size(), 1u);
  EXPECT_TRUE(has_point_at(seen, {0.5, 1.0}));
}

TEST(SeenPoints, WhatIsTooFarOrNoDistanceIsLeftOut) {
  SeenPoints seen({.reach = 2.0});
  Sweep sweep(infinity);
  sweep.beam(0) = 2.1f;
  sweep.beam(10) = nan;
  sweep.beam(20) = -infinity;
  sweep.beam(30) = 0.05f;
  sweep.beam(40) = -1.0f;
  seen.look({}, sweep.scan(), at(0s));
  EXPECT_TRUE(seen.points().empty());
}

TEST(SeenPoints, OfPointsThatLieCloseTogetherOneIsKept) {
  SeenPoints seen({.spacing = 0.1});
  seen.look({}, Sweep(0.5f).scan(), at(0s));
  EXPECT_LT(seen.points().size(), 40u);  // of 271 on an arc of 2.4 m
  EXPECT_GT(seen.points().size(), 20u);
}

TEST(SeenPoints, WhatIsSeenNoMoreWhereABeamPassesIsGone) {
  SeenPoints seen({});
  Sweep sweep(infinity);
  sweep.beam(0) = 1.0f;
  seen.look({}, sweep.scan(), at(0s));
  ASSERT_TRUE(has_point_at(seen, {1.0, 0.0}));
  seen.look({}, Sweep(infinity).scan(), at(50ms));
  EXPECT_TRUE(seen.points().empty());
}

TEST(SeenPoints, WhatIsBehindTheRobotIsRememberedForAWhile) {
  SeenPoints seen({.memory = 2s});
  Sweep sweep(infinity);
  sweep.beam(0) = 1.0f;
  seen.look({}, sweep.scan(), at(0s));
  seen.look({0.0, 0.0, pi}, Sweep(infinity).scan(), at(1s));  // it has turned its back to it
  EXPECT_TRUE(has_point_at(seen, {1.0, 0.0}));
  seen.look({0.0, 0.0, pi}, Sweep(infinity).scan(), at(2100ms));
  EXPECT_TRUE(seen.points().empty());
}

TEST(SeenPoints, WhatIsBehindSomethingElseIsRemembered) {
  SeenPoints seen({});
  Sweep sweep(infinity);
  sweep.beam(0) = 1.5f;
  seen.look({}, sweep.scan(), at(0s));
  for (const float in_between : {0.8f, -infinity, nan}) {
    sweep.beam(0) = in_between;
    seen.look({}, sweep.scan(), at(50ms));
    EXPECT_TRUE(has_point_at(seen, {1.5, 0.0})) << in_between;
  }
}

TEST(SeenPoints, WhatIsLeftBehindIsForgotten) {
  SeenPoints seen({.reach = 2.0});
  Sweep sweep(infinity);
  sweep.beam(0) = 1.0f;
  seen.look({}, sweep.scan(), at(0s));
  seen.look({3.5, 0.0, 0.0}, Sweep(infinity).scan(), at(1s));
  EXPECT_TRUE(seen.points().empty());
}

TEST(SeenPoints, ScansMayTurnToTheRight) {
  SeenPoints seen({});
  Sweep sweep(infinity);
  sweep.beam(-90) = 1.0f;
  geometry::Scan scan = sweep.scan();
  scan.angle_min = -scan.angle_min;
  scan.angle_increment = -scan.angle_increment;
  seen.look({}, scan, at(0s));
  EXPECT_TRUE(has_point_at(seen, {0.0, 1.0}));
  sweep.beam(-90) = infinity;
  seen.look({}, scan, at(50ms));
  EXPECT_TRUE(seen.points().empty());
}

TEST(SeenPoints, EchoesWithoutAScanStayUntilTheyAreForgotten) {
  SeenPoints seen({.memory = 2s});
  const std::vector<Vector2> echo{{1.0, 0.5}}, other{{1.0, -0.5}}, none{};
  seen.add(echo, {0.0, 0.0}, at(0s));
  seen.add(other, {0.0, 0.0}, at(1500ms));
  EXPECT_TRUE(has_point_at(seen, {1.0, 0.5}));
  EXPECT_TRUE(has_point_at(seen, {1.0, -0.5}));
  seen.add(none, {0.0, 0.0}, at(2500ms));
  EXPECT_FALSE(has_point_at(seen, {1.0, 0.5}));
  EXPECT_TRUE(has_point_at(seen, {1.0, -0.5}));
  seen.forget();
  EXPECT_TRUE(seen.points().empty());
}

}  // namespace
}  // namespace kervan::control
