// Trigger, action and end of each behaviour, as Parlaktuna and Eroglu's table of behaviours has them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "components/behavior/bumper.hpp"
#include "components/behavior/convex_corner.hpp"
#include "components/behavior/front_avoid.hpp"
#include "components/behavior/side_avoid.hpp"
#include "components/behavior/stall_recover.hpp"
#include "components/behavior/wall_find.hpp"
#include "components/behavior/wall_follow.hpp"
#include "tests/unit/components/p3dx_ring.hpp"

namespace kervan::behavior {
namespace {

using namespace std::chrono_literals;
using geometry::Pose2;
using geometry::radians;
using test::p3dx_ring;
using test::Ranges;

Situation hearing(Ranges ranges, Duration since_start = 0s, const Pose2& pose = {}) {
  return {.now = Time(since_start), .ring = p3dx_ring(ranges), .pose = pose, .speed = {}};
}

/// The wall beside the robot, before and behind its wheels.
Situation beside(double r7, double r8, Duration since_start = 0s) { return hearing({{7, r7}, {8, r8}}, since_start); }

TEST(WallFollow, DrivesStraightOnInTheMiddleOfTheBandParallelToTheWall) {
  WallFollow follow({});
  const Wish wish = follow.step(beside(0.40, 0.40));
  EXPECT_TRUE(wish.active);
  EXPECT_EQ(wish.twist.linear, 0.2);
  EXPECT_EQ(wish.twist.angular, 0.0);
}

TEST(WallFollow, TurnsInProportionToAngleAndDistance) {
  WallFollow follow({});
  EXPECT_NEAR(follow.step(beside(0.44, 0.40)).twist.angular, -1.2 * std::atan(0.04 / 0.226) - 1.5 * 0.02, 1e-12);
  EXPECT_NEAR(follow.step(beside(0.40, 0.44)).twist.angular, 1.2 * std::atan(0.04 / 0.226) - 1.5 * 0.02, 1e-12);
  EXPECT_NEAR(follow.step(beside(0.50, 0.50)).twist.angular, -0.15, 1e-12);
  EXPECT_NEAR(follow.step(beside(0.30, 0.30)).twist.angular, 0.15, 1e-12);
  EXPECT_EQ(follow.step(beside(0.95, 0.80)).twist.angular, -0.5) << "no more than the highest turning rate";
}

TEST(WallFollow, GoesByTheDistanceAloneWhereOneTransducerHasTheWallOrBothHaveDifferentThings) {
  WallFollow follow({});
  EXPECT_NEAR(follow.step(hearing({{7, 0.5}})).twist.angular, -0.15, 1e-12);
  EXPECT_NEAR(follow.step(hearing({{8, 0.3}})).twist.angular, 0.15, 1e-12);
  EXPECT_NEAR(follow.step(beside(0.45, 0.90)).twist.angular, -0.075, 1e-12);
}

TEST(WallFollow, BelievesInTheWallForTwoSeconds) {
  WallFollow follow({});
  EXPECT_FALSE(follow.step(hearing({}, 0s)).active) << "it has never had one";
  EXPECT_TRUE(follow.step(beside(0.4, 0.4, 1s)).active);
  const Wish remembered = follow.step(hearing({}, 3s));
  EXPECT_TRUE(remembered.active);
  EXPECT_EQ(remembered.twist.angular, 0.0);
  EXPECT_FALSE(follow.step(hearing({}, 3s + 1ms)).active);
}

TEST(WallFollow, EndsWhereTheWallIsAMetreAway) {
  WallFollow follow({});
  EXPECT_TRUE(follow.step(beside(0.99, 0.99)).active);
  EXPECT_FALSE(WallFollow({}).step(beside(1.0, 1.0)).active);
}

TEST(WallFollowByThePaper, StepsOneDegreeEveryTenthOfASecond) {
  WallFollow follow({.law = FollowLaw::paper});
  const double degree = radians(10.0);
  EXPECT_EQ(follow.step(beside(0.400, 0.404)).twist.angular, 0.0) << "parallel within 5 mm";
  EXPECT_EQ(follow.step(beside(0.410, 0.400)).twist.angular, -degree) << "the nose points away from the wall";
  EXPECT_EQ(follow.step(beside(0.400, 0.410)).twist.angular, degree);
  EXPECT_EQ(follow.step(beside(0.340, 0.345)).twist.angular, degree) << "too near";
  EXPECT_NEAR(follow.step(beside(0.600, 0.600)).twist.angular, -1.5 * 0.2, 1e-12) << "too far: by the error";
}

TEST(SideAvoid, TurnsFiveDegreesAwayFromWhatIsNearerThan200Millimetres) {
  SideAvoid avoid({});
  EXPECT_FALSE(avoid.step(hearing({{7, 0.2}, {8, 0.2}, {0, 0.2}, {15, 0.2}})).active);
  const Wish right = avoid.step(hearing({{7, 0.19}}));
  EXPECT_TRUE(right.active);
  EXPECT_EQ(right.twist.angular, radians(50.0)) << "5 degrees in 100 ms, to the left";
  EXPECT_EQ(avoid.step(hearing({{0, 0.19}})).twist.angular, -radians(50.0));
}

TEST(SideAvoid, DoesNotSwingItsTailIntoTheWall) {
  SideAvoid avoid({});
  const Wish wish = avoid.step(beside(0.24, 0.18));
  EXPECT_TRUE(wish.active);
  EXPECT_GT(wish.twist.linear, 0.0);
  EXPECT_EQ(wish.twist.angular, 0.0);
  EXPECT_EQ(avoid.step(hearing({{0, 0.18}, {7, 0.18}})).twist.angular, 0.0) << "a passage";
}

TEST(SideAvoid, TurnsByTenDegreesAtMostUntilTheSideHasBeenFree) {
  SideAvoid avoid({});
  EXPECT_LT(avoid.step(hearing({{0, 0.19}})).twist.angular, 0.0);
  EXPECT_LT(avoid.step(hearing({{0, 0.19}}, 100ms, {0, 0, radians(-9)})).twist.angular, 0.0);
  const Wish wish = avoid.step(hearing({{0, 0.19}}, 200ms, {0, 0, radians(-11)}));
  EXPECT_TRUE(wish.active);
  EXPECT_EQ(wish.twist.angular, 0.0);
  EXPECT_EQ(wish.twist.linear, 0.1);
  EXPECT_FALSE(avoid.step(hearing({{0, 0.21}}, 300ms, {0, 0, radians(-11)})).active);
  EXPECT_LT(avoid.step(hearing({{0, 0.19}}, 400ms, {0, 0, radians(-11)})).twist.angular, 0.0);
}

TEST(FrontAvoid, TurnsLeftBy90DegreesBeforeWhatIsNearerThan400Millimetres) {
  FrontAvoid avoid({});
  EXPECT_FALSE(avoid.step(hearing({{2, 0.4}, {3, 0.4}, {4, 0.4}, {5, 0.4}, {1, 0.2}, {6, 0.2}})).active);
  const Wish wish = avoid.step(hearing({{5, 0.39}}));
  EXPECT_TRUE(wish.active);
  EXPECT_EQ(wish.twist.linear, 0.0);
  EXPECT_GT(wish.twist.angular, 0.0);
  EXPECT_TRUE(avoid.step(hearing({}, 1s, {0, 0, radians(45)})).active) << "though the way is free";
  EXPECT_TRUE(avoid.step(hearing({}, 2s, {0, 0, radians(89)})).active);
  EXPECT_FALSE(avoid.step(hearing({}, 3s, {0, 0, radians(90)})).active);
}

TEST(FrontAvoid, TurnsOnWhileTheWayIsBlocked) {
  FrontAvoid avoid({});
  avoid.step(hearing({{3, 0.3}}));
  avoid.step(hearing({{3, 0.3}}, 1s, {0, 0, radians(80)}));
  EXPECT_TRUE(avoid.step(hearing({{3, 0.3}}, 2s, {0, 0, radians(100)})).active);
  EXPECT_FALSE(avoid.step(hearing({}, 3s, {0, 0, radians(110)})).active);
}

/// A wall that ends: nothing ahead and on the right, and its end behind on the right.
Situation wall_has_ended(Duration since_start = 0s, double yaw = 0.0) {
  return hearing({{8, 0.42}, {9, 0.48}}, since_start, {0, 0, yaw});
}

TEST(ConvexCorner, GoesRoundTheEndOfAWallUntilOneIsBesideTheRobot) {
  ConvexCorner corner({});
  const Wish wish = corner.step(wall_has_ended());
  EXPECT_TRUE(wish.active);
  EXPECT_EQ(wish.twist.linear, 0.2);
  EXPECT_NEAR(wish.twist.angular, -0.2 / 0.62, 1e-12);
  EXPECT_TRUE(corner.step(hearing({}, 1s, {0, 0, radians(-60)})).active) << "nothing is heard half way round";
  EXPECT_FALSE(corner.step(hearing({{7, 0.55}}, 3s, {0, 0, radians(-85)})).active);
}

TEST(ConvexCorner, IsNoneWhileSomethingIsAheadOrBesideTheRobot) {
  EXPECT_FALSE(ConvexCorner({}).step(hearing({{8, 0.42}, {3, 0.45}})).active);
  EXPECT_FALSE(ConvexCorner({}).step(hearing({{8, 0.42}, {6, 0.45}})).active);
  EXPECT_FALSE(ConvexCorner({}).step(hearing({{8, 0.42}, {7, 0.45}})).active);
  EXPECT_FALSE(ConvexCorner({}).step(hearing({})).active) << "there was no wall";
}

TEST(ConvexCorner, IsWhereAWallWasLostWithinTwoSeconds) {
  ConvexCorner corner({});
  corner.step(beside(0.4, 0.4, 0s));
  EXPECT_TRUE(corner.step(hearing({}, 2s)).active);
  ConvexCorner late({});
  late.step(beside(0.4, 0.4, 0s));
  EXPECT_FALSE(late.step(hearing({}, 2s + 1ms)).active);
}

TEST(ConvexCorner, GivesUpAfter216DegreesUntilThereIsAWallAgain) {
  ConvexCorner corner({});
  corner.step(wall_has_ended());
  for (int degrees = 0; degrees <= 216; ++degrees)
    EXPECT_TRUE(corner.step(hearing({}, 1s, {0, 0, geometry::wrap_angle(radians(-degrees))})).active) << degrees;
  EXPECT_FALSE(corner.step(hearing({}, 9s, {0, 0, radians(-217)})).active);
  EXPECT_FALSE(corner.step(wall_has_ended(10s)).active);
  corner.step(beside(0.4, 0.4, 11s));
  EXPECT_TRUE(corner.step(wall_has_ended(12s)).active);
}

TEST(ConvexCorner, LeavesWhatIsAheadToTheConcaveCorner) {
  ConvexCorner corner({});
  corner.step(wall_has_ended());
  EXPECT_FALSE(corner.step(hearing({{4, 0.39}}, 1s, {0, 0, radians(-30)})).active);
}

TEST(WallFind, LooksAroundDrivesToTheNearestWallAndTurnsItToTheSide) {
  WallFind find({});
  // A wall 3 m away at 120 degrees, a nearer one, 2 m, at 200.
  for (int degrees = 0; degrees < 360; ++degrees) {
    const double to_far = std::abs(degrees - 120), to_near = std::abs(degrees - 200);
    const double range = to_near < 8 ? 2.0 : to_far < 8 ? 3.0 : nothing;
    const Wish wish = find.step(hearing({{3, range}}, 0s, {0, 0, geometry::wrap_angle(radians(degrees))}));
    EXPECT_TRUE(wish.active);
    EXPECT_EQ(wish.twist.linear, 0.0);
    EXPECT_GT(wish.twist.angular, 0.0);
  }
  find.step(hearing({}, 1s, {0, 0, 1e-9}));
  EXPECT_EQ(find.phase(), WallFind::Phase::drive);
  EXPECT_NE(find.step(hearing({}, 1s, {0, 0, 0})).twist.angular, 0.0) << "it turns before it drives";
  EXPECT_EQ(find.step(hearing({}, 1s, {0, 0, 0})).twist.linear, 0.0);
  const Wish driving = find.step(hearing({{3, 1.9}}, 2s, {0, 0, radians(-165)}));
  EXPECT_EQ(driving.twist.linear, 0.2);
  EXPECT_LT(find.step(hearing({{3, 0.43}}, 3s, {-1.5, 0, radians(-165)})).twist.linear, 0.2) << "it brakes";
  const Wish aligning = find.step(hearing({{3, 0.40}}, 4s, {-1.5, 0, radians(-165)}));
  EXPECT_EQ(find.phase(), WallFind::Phase::align);
  EXPECT_EQ(aligning.twist.linear, 0.0);
  EXPECT_GT(aligning.twist.angular, 0.0) << "counter-clockwise";
  EXPECT_TRUE(find.step(hearing({{7, 0.45}, {8, 0.50}}, 5s, {-1.5, 0, radians(-95)})).active) << "not parallel yet";
  EXPECT_FALSE(find.step(hearing({{7, 0.43}, {8, 0.43}}, 6s, {-1.5, 0, radians(-75)})).active);
  EXPECT_EQ(find.phase(), WallFind::Phase::idle);
}

/// A look around at the origin; `range` tells what is ahead in each direction, in degrees.
template <class Range>
void look_around(WallFind& find, Range range) {
  for (int degrees = 0; degrees <= 361; ++degrees)
    find.step(hearing({{3, range(degrees % 360)}}, 0s, {0, 0, geometry::wrap_angle(radians(degrees))}));
}

TEST(WallFind, DrivesTowardsTheMiddleOfTheDirectionsInWhichTheSameThingWasNearest) {
  // Heard from 300 over 0 to 20 degrees, with noise that makes one at the edge the nearest.
  WallFind find({});
  look_around(find, [](int degrees) { return degrees == 15 ? 1.97 : degrees >= 300 || degrees <= 20 ? 2.0 : 3.0; });
  ASSERT_EQ(find.phase(), WallFind::Phase::drive);
  const Wish ahead = find.step(hearing({}, 1s, {0, 0, radians(-20)}));
  EXPECT_EQ(ahead.twist.linear, 0.2);
  EXPECT_NEAR(ahead.twist.angular, 0.0, radians(5.0)) << "-20 degrees, but for the sectors";
}

TEST(WallFind, TurnsTheWallToTheSideWhereItMustBeThoughItIsNotHeardAnyMore) {
  WallFind find({});
  look_around(find, [](int degrees) { return degrees <= 10 || degrees >= 350 ? 2.0 : nothing; });
  find.step(hearing({}, 1s, {1.55, 0, 0}));
  EXPECT_EQ(find.phase(), WallFind::Phase::drive);
  find.step(hearing({}, 2s, {1.61, 0, 0}));
  EXPECT_EQ(find.phase(), WallFind::Phase::align) << "2.0 m less the 0.4 to stop before it";
}

TEST(WallFind, LooksAgainAtOnceWhereTheTurnDidNotBringAWallBesideIt) {
  WallFind find({});
  look_around(find, [](int) { return 1.0; });
  find.step(hearing({{3, 0.39}}));
  ASSERT_EQ(find.phase(), WallFind::Phase::align);
  EXPECT_TRUE(find.step(hearing({}, 1s, {0, 0, radians(100)})).active);
  EXPECT_TRUE(find.step(hearing({}, 2s, {0, 0, radians(131)})).active) << "somebody has to be";
  EXPECT_EQ(find.phase(), WallFind::Phase::look);
}

TEST(WallFind, WantsNothingWhileAWallIsWithinAMetreOnTheRight) {
  EXPECT_FALSE(WallFind({}).step(beside(0.99, nothing)).active);
  EXPECT_TRUE(WallFind({}).step(beside(1.0, 1.0)).active);
}

TEST(WallFind, DrivesInAGrowingSquareAndLooksAgainWhereNothingIsHeard) {
  WallFind find({});
  Pose2 pose;
  for (const double leg : {2.0, 2.0, 4.0, 4.0, 6.0}) {
    for (int degrees = 0; degrees <= 361; ++degrees)
      find.step(hearing({}, 0s, {pose.x, pose.y, geometry::wrap_angle(pose.yaw + radians(degrees))}));
    ASSERT_EQ(find.phase(), WallFind::Phase::drive);
    const Pose2 start = pose;
    for (const double driven : {0.1, leg - 0.1}) {
      pose = start * Pose2{driven, 0.0, 0.0};
      const Wish wish = find.step(hearing({}, 1s, pose));
      EXPECT_EQ(wish.twist.linear, 0.2) << leg;
      EXPECT_NEAR(wish.twist.angular, 0.0, 0.05);
    }
    pose = start * Pose2{leg + 0.1, 0.0, radians(90)};
    find.step(hearing({}, 2s, pose));
    EXPECT_EQ(find.phase(), WallFind::Phase::look);
  }
}

TEST(WallFind, BeginsAnewWhereAnotherBehaviourHasCarriedItOff) {
  WallFind find({});
  for (int degrees = 0; degrees <= 300; ++degrees)
    find.step(hearing({{3, 2.0}}, 0s, {0, 0, geometry::wrap_angle(radians(degrees))}));
  for (int degrees = 301; degrees <= 420; ++degrees)
    find.step(hearing({{3, 2.0}}, 1s, {0.3, 0, geometry::wrap_angle(radians(degrees))}));
  EXPECT_EQ(find.phase(), WallFind::Phase::look);
}

TEST(Bumper, DrivesAwayFromTheSwitchUntilItIsFreeAndALittleFurther) {
  Bumper bumper({});
  EXPECT_FALSE(bumper.step(hearing({})).active);
  Situation bumped = hearing({});
  bumped.pressed = {{-0.34, 0.0}};
  EXPECT_EQ(bumper.step(bumped).twist.linear, 0.1) << "bumped at the rear: forward";
  EXPECT_TRUE(bumper.step(hearing({}, 1s, {0.14, 0, 0})).active);
  EXPECT_FALSE(bumper.step(hearing({}, 2s, {0.15, 0, 0})).active);
  bumped.pressed = {{0.26, 0.0}};
  EXPECT_EQ(bumper.step(bumped).twist.linear, -0.1) << "at the front: backward";
}

TEST(Bumper, StandsWhenPressedAtBothEndsAndGivesUpOnARobotThatDoesNotMove) {
  Bumper bumper({});
  Situation bumped = hearing({});
  bumped.pressed = {{-0.34, 0.0}, {0.26, 0.0}};
  const Wish wish = bumper.step(bumped);
  EXPECT_TRUE(wish.active);
  EXPECT_EQ(wish.twist.linear, 0.0);
  bumped.pressed = {{-0.34, 0.0}};
  bumper.step(bumped);
  EXPECT_TRUE(bumper.step(hearing({}, 3s)).active);
  EXPECT_FALSE(bumper.step(hearing({}, 3s + 1ms)).active);
}

Situation stalled(bool left, bool right, Duration since_start) {
  Situation situation = hearing({}, since_start);
  situation.stall = {left, right};
  return situation;
}

TEST(StallRecover, BacksUpAndTurnsAwayFromTheStalledWheel) {
  StallRecover left({});
  const Wish wish = left.step(stalled(true, false, 0s));
  EXPECT_TRUE(wish.active);
  EXPECT_EQ(wish.twist.linear, -0.15);
  EXPECT_LT(wish.twist.angular, 0.0) << "the left wheel is stalled: to the right";
  EXPECT_GT(StallRecover({}).step(stalled(false, true, 0s)).twist.angular, 0.0);
  EXPECT_TRUE(left.step(hearing({}, 4999ms)).active);
  EXPECT_FALSE(left.step(hearing({}, 5s)).active);
}

TEST(StallRecover, TurnsToTheFreeSideWhenBothWheelsAreStalled) {
  Situation situation = stalled(true, true, 0s);
  situation.ring = p3dx_ring({{7, 0.5}, {0, 1.5}});
  EXPECT_GT(StallRecover({}).step(situation).twist.angular, 0.0);
  situation.ring = p3dx_ring({{7, 1.5}, {15, 0.5}});
  EXPECT_LT(StallRecover({}).step(situation).twist.angular, 0.0);
}

TEST(StallRecover, StopsTurningAfter45Degrees) {
  StallRecover recover({});
  recover.step(stalled(false, true, 0s));
  EXPECT_GT(recover.step(hearing({}, 1s, {0, 0, radians(44)})).twist.angular, 0.0);
  EXPECT_EQ(recover.step(hearing({}, 2s, {0, 0, radians(45)})).twist.angular, 0.0);
}

TEST(StallRecover, GoesThroughArActionStallRecoversSequenceAsLongAsStallsFollowEachOther) {
  // back|turn, forward|turn, back, forward, left, right, back|left, back|right, forward|left, forward|right
  const double drive[] = {-1, 1, -1, 1, 0, 0, -1, -1, 1, 1};
  const double turn[] = {1, 1, 0, 0, 1, -1, 1, -1, 1, -1};
  StallRecover recover({});
  Duration now = 0s;
  for (std::size_t i = 0; i < 10; ++i) {
    const Wish wish = recover.step(stalled(false, true, now));
    EXPECT_EQ(recover.attempt(), i);
    EXPECT_EQ(std::copysign(wish.twist.linear != 0.0, wish.twist.linear), drive[i]) << i;
    EXPECT_EQ(std::copysign(wish.twist.angular != 0.0, wish.twist.angular), turn[i]) << i;
    now += 5s;
    EXPECT_FALSE(recover.step(hearing({}, now)).active);
    now += 4s;
  }
  recover.step(stalled(false, true, now));
  EXPECT_EQ(recover.attempt(), 0u) << "the sequence begins anew";
  EXPECT_FALSE(recover.step(hearing({}, now + 5s)).active);
  recover.step(stalled(false, true, now + 10s + 1ms));
  EXPECT_EQ(recover.attempt(), 0u) << "a stall after a pause is a new one";
}

TEST(StallRecover, DoesNotDriveOnTowardsAnObstacleInTheSecondHalf) {
  StallRecover recover({});
  recover.step(stalled(false, true, 0s));
  EXPECT_EQ(recover.step(hearing({{11, 0.2}}, 2400ms)).twist.linear, -0.15);
  EXPECT_EQ(recover.step(hearing({{11, 0.2}}, 2600ms)).twist.linear, 0.0);
  EXPECT_EQ(recover.step(hearing({{11, 0.23}}, 2700ms)).twist.linear, -0.15);
}

/// All seven, asked at once.
struct Everybody {
  WallFind find{{}};
  WallFollow follow{{}};
  ConvexCorner convex{{}};
  SideAvoid side{{}};
  FrontAvoid front{{}};
  Bumper bumper{{}};
  StallRecover stall{{}};

  geometry::Twist2 drives;  ///< what the strongest of the last step wants

  int active(const Situation& situation) {
    int count = 0;
    for (const Wish& wish : {find.step(situation), follow.step(situation), convex.step(situation), side.step(situation),
                             front.step(situation), bumper.step(situation), stall.step(situation)}) {
      count += wish.active;
      if (wish.active) drives = wish.twist;
      EXPECT_TRUE(std::isfinite(wish.twist.linear) && std::isfinite(wish.twist.angular));
      EXPECT_TRUE(wish.active || wish.twist == geometry::Twist2{});
      EXPECT_FALSE(wish.why.empty());
    }
    return count;
  }
};

TEST(AllBehaviours, SomeAreActiveWhateverTheSonarsHear) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(0.0, 1.2), turn(-3.0, 3.0);
  std::bernoulli_distribution silent(0.4), again(0.9);
  Everybody everybody;
  Situation situation = hearing({});
  for (int i = 0; i < 20000; ++i) {
    if (i % 50 == 0) everybody = Everybody();
    situation.now += 100ms;
    if (!again(random)) situation.pose = {any(random), any(random), turn(random)};
    for (SonarReading& reading : situation.ring)
      if (!again(random)) reading.range = silent(random) ? nothing : any(random);
    ASSERT_GT(everybody.active(situation), 0) << i;
  }
}

TEST(AllBehaviours, SomeAreActiveWhereverTheyDriveTheRobot) {
  // Echoes come and go while the robot does what it is told, so that each behaviour comes through all it does.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(0.2, 3.0);
  std::bernoulli_distribution silent(0.8), again(0.98);
  Everybody everybody;
  Situation situation = hearing({});
  for (int i = 0; i < 20000; ++i) {
    situation.now += 250ms;
    const Pose2 step{0.25 * everybody.drives.linear, 0.0, 0.25 * everybody.drives.angular};
    situation.pose = situation.pose * step;
    for (SonarReading& reading : situation.ring)
      if (!again(random)) reading.range = silent(random) ? nothing : any(random);
    ASSERT_GT(everybody.active(situation), 0) << i;
  }
}

TEST(AllBehaviours, SomeAreActiveForEveryCombinationOfNearAndFar) {
  // Each of the sixteen hears something within every threshold, or nothing.
  for (unsigned mask = 0; mask < 1u << ring_size; ++mask) {
    Situation situation = hearing({});
    for (std::size_t i = 0; i < ring_size; ++i)
      if (mask >> i & 1u) situation.ring[i].range = 0.3;
    ASSERT_GT(Everybody().active(situation), 0) << mask;
  }
}

}  // namespace
}  // namespace kervan::behavior
