#include "components/behavior/senses.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/components/p3dx_ring.hpp"

namespace kervan::behavior {
namespace {

using namespace std::chrono_literals;
using geometry::radians;
using geometry::Vector2;
using test::p3dx_ring;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

TEST(SonarView, DividesTheRingAsTheBehavioursDo) {
  SonarRing ring = p3dx_ring();
  for (std::size_t i = 0; i < ring_size; ++i) ring[i].range = 1.0 + 0.1 * static_cast<double>(i);
  const SonarView view(ring);
  EXPECT_EQ(view.front(), ring[2].range);
  EXPECT_EQ(view.ahead(), ring[3].range);
  EXPECT_EQ(view.right(), ring[4].range);
  EXPECT_EQ(view.rear_right(), ring[8].range) << "8 is of the rear, 7 of the right";
  EXPECT_EQ(view.right_front(), ring[7].range);
  EXPECT_EQ(view.beside(), ring[7].range);
  EXPECT_NEAR(view.spacing(), 0.226, 1e-12);
}

TEST(SonarView, HearsAFeltPointWithTheTransducersWhoseConeItLiesIn) {
  // 0.3 m before transducer 4, which looks 10 degrees to the right.
  const SonarRing ring = p3dx_ring({{4, 2.0}});
  const Vector2 point = ring[4].transducer * Vector2(0.3, 0.0);
  const SonarView view(ring, {{point}});
  EXPECT_NEAR(view[4], 0.3, 1e-12);
  EXPECT_EQ(view.heard(4), 2.0);
  EXPECT_EQ(view[7], nothing);
  EXPECT_EQ(view[11], nothing);
}

TEST(SonarView, LosesNoFeltPointBetweenTheConesOrWithinTheRing) {
  for (int degrees = 0; degrees < 360; ++degrees)
    for (const double distance : {0.25, 0.4, 1.0}) {
      const Vector2 point = distance * geometry::heading(radians(degrees));
      const SonarView view(p3dx_ring(), {{point}});
      EXPECT_LT(view.least(0, 15), distance + 0.3) << degrees << " degrees, " << distance << " m";
    }
}

TEST(SonarRing, FitsOnlyIfItLooksAsThatOfAPioneer) {
  const SonarRing good = p3dx_ring();
  EXPECT_EQ(misfit(good), "");
  EXPECT_EQ(misfit(std::span(good).first(8)), "8 readings, but the ring of a Pioneer has 16");
  SonarRing turned = good;
  turned[5].transducer.yaw = radians(-50.0);
  EXPECT_EQ(misfit(turned), "transducer 5 does not look to -30 degrees, as that of a Pioneer does");
  turned = good;
  turned[9].transducer.x = nan;
  EXPECT_EQ(misfit(turned), "transducer 9 does not look to -130 degrees, as that of a Pioneer does");
  turned = good;
  std::swap(turned[7], turned[8]);
  EXPECT_EQ(misfit(turned), "transducer 7 does not stand before transducer 8");
}

TEST(SonarRing, IsItselfInTheMirror) {
  SonarRing ring = p3dx_ring({{0, 0.1}, {6, 0.6}, {8, 0.8}, {12, 1.2}});
  const SonarRing mirror = mirrored(ring);
  EXPECT_EQ(misfit(mirror), "");
  EXPECT_EQ(mirror[7].range, 0.1);
  EXPECT_EQ(mirror[1].range, 0.6);
  EXPECT_EQ(mirror[15].range, 0.8);
  EXPECT_EQ(mirror[11].range, 1.2);
  for (std::size_t i = 0; i < ring_size; ++i) {
    EXPECT_NEAR(mirror[i].transducer.y, ring[i].transducer.y, 1e-12) << i;
    EXPECT_EQ(mirrored(mirror)[i].range, ring[i].range) << i;
  }
}

/// Senses that have heard nothing at the origin.
Senses senses(const SensesParams& params = {}) {
  Senses result(params);
  result.hear(p3dx_ring(), 5.0, Time());
  result.move({}, {});
  return result;
}

TEST(Senses, LeaveOutRangesThatCannotBeAndCountThem) {
  Senses result = senses();
  EXPECT_EQ(result.hear(p3dx_ring({{0, -inf}, {1, -0.5}, {2, 6.0}, {3, 0.7}}), 5.0, Time()), "");
  EXPECT_EQ(result.refused(), 2u);
  EXPECT_TRUE(result.absurd());
  const SonarView view = result.at(Time()).view();
  EXPECT_EQ(view[0], nothing);
  EXPECT_EQ(view[1], nothing);
  EXPECT_EQ(view[2], nothing) << "beyond the largest range there is no echo";
  EXPECT_EQ(view[3], 0.7);
}

TEST(Senses, KeepTheLastReadingOfATransducerThatDidNotFireForHalfASecond) {
  Senses result = senses();
  result.hear(p3dx_ring({{3, 0.7}}), 5.0, Time(1s));
  result.hear(p3dx_ring({{3, nan}, {4, 0.8}}), 5.0, Time(1400ms));
  EXPECT_FALSE(result.absurd());
  EXPECT_EQ(result.at(Time(1500ms)).view()[3], 0.7);
  EXPECT_EQ(result.at(Time(1501ms)).view()[3], nothing);
  EXPECT_EQ(result.at(Time(1501ms)).view()[4], 0.8);
}

TEST(Senses, KeepTheLastGoodRoundAndPose) {
  Senses result = senses();
  result.hear(p3dx_ring({{3, 0.7}}), 5.0, Time());
  EXPECT_NE(result.hear(std::span<const SonarReading>(), 5.0, Time()), "");
  EXPECT_FALSE(result.move({nan, 0.0, 0.0}, {}));
  EXPECT_EQ(result.refused(), 2u);
  EXPECT_EQ(result.at(Time()).view()[3], 0.7);
  EXPECT_EQ(result.at(Time()).pose.x, 0.0);
}

TEST(Senses, AreIncompleteUntilSonarAndOdometryHaveSpoken) {
  Senses result({});
  EXPECT_FALSE(result.complete());
  result.hear(p3dx_ring(), 5.0, Time());
  EXPECT_FALSE(result.complete());
  result.move({}, {});
  EXPECT_TRUE(result.complete());
}

TEST(Senses, RememberAContactFor15SecondsWhereItWas) {
  Senses result = senses();
  result.press(std::vector<Vector2>{{0.26, 0.0}}, Time(1s));
  EXPECT_EQ(result.at(Time(1s)).pressed.size(), 1u);
  result.press({}, Time(2s));
  result.move({-0.4, 0.0, 0.0}, {});
  const Situation later = result.at(Time(16s));
  EXPECT_TRUE(later.pressed.empty());
  ASSERT_EQ(later.felt.size(), 1u);
  EXPECT_NEAR(later.felt[0].x(), 0.66, 1e-12) << "the robot has backed off by 0.4 m";
  EXPECT_LT(later.view().front(), 0.51);
  EXPECT_TRUE(result.at(Time(16s + 1ms)).felt.empty());
}

TEST(Senses, RefuseBumpersThatAreNowhere) {
  Senses result = senses();
  result.press(std::vector<Vector2>{{nan, 0.0}}, Time());
  EXPECT_EQ(result.refused(), 1u);
  EXPECT_TRUE(result.at(Time()).pressed.empty());
}

TEST(Senses, TakeAStallForAnObstacleAtTheStalledSideOfTheEndThatLed) {
  Senses forward = senses();
  forward.move({}, {0.2, 0.0});
  forward.move({}, {0.0, 0.0});
  forward.stall({.left = true, .right = false}, Time());
  ASSERT_EQ(forward.at(Time()).felt.size(), 1u);
  EXPECT_EQ(forward.at(Time()).felt[0], Vector2(0.211, 0.110));
  Senses backward = senses();
  backward.move({}, {-0.2, 0.0});
  backward.stall({.left = true, .right = true}, Time());
  EXPECT_EQ(backward.at(Time()).felt[0], Vector2(-0.300, 0.0));
}

TEST(Senses, MirrorEverythingForAWallOnTheLeft) {
  Senses result = senses({.side = Side::left});
  result.hear(p3dx_ring({{0, 0.4}, {6, 0.9}}), 5.0, Time());
  result.move({1.0, 2.0, 0.5}, {0.2, 0.1});
  result.press(std::vector<Vector2>{{0.17, 0.22}}, Time());
  result.stall({.left = true, .right = false}, Time());
  const Situation situation = result.at(Time());
  EXPECT_EQ(situation.view().right_front(), 0.4);
  EXPECT_EQ(situation.view().heard(1), 0.9);
  EXPECT_EQ(situation.pose, (geometry::Pose2{1.0, -2.0, -0.5}));
  EXPECT_EQ(situation.speed.angular, -0.1);
  EXPECT_EQ(situation.pressed[0], Vector2(0.17, -0.22));
  EXPECT_TRUE(situation.stall.right);
  EXPECT_LT(situation.felt[0].y(), 0.0);
  const Wish wish = result.unmirrored({true, {0.2, 0.3}, "x"});
  EXPECT_EQ(wish.twist, (geometry::Twist2{0.2, -0.3}));
}

}  // namespace
}  // namespace kervan::behavior
