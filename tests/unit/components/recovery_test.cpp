#include "components/control/recovery.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace kervan::control {
namespace {

using namespace std::chrono_literals;
using geometry::Pose2;
using geometry::Twist2;
using geometry::Vector2;

constexpr Duration period = 100ms;
constexpr double pi = 3.14159265358979;

Room open_room() { return {.ahead = 3.0, .behind = 3.0, .left = 3.0, .right = 3.0, .around = 3.0}; }
Room in_a_corner() { return {.ahead = 0.1, .behind = 2.0, .left = 0.5, .right = 0.6, .around = 0.35}; }

/// A robot that a recovery looks after, 10 m before its target.
struct Robot {
  Recovery recovery;
  Pose2 pose{};
  Room room = open_room();
  Time now{};
  std::vector<Rung> rungs;
  std::string why;

  explicit Robot(const RecoveryParams& params = {}) : recovery(params) {}

  Recovering step(const Twist2& command, const Vector2& target = {10.0, 0.0}) {
    now += period;
    const Recovering recovering = recovery.step(now, pose, target, command, room);
    if (recovering.begun) {
      rungs.push_back(*recovering.begun);
      why = recovering.why;
    }
    return recovering;
  }
  /// Stands for a time, whatever it is told to.
  void stand(Duration time, const Twist2& command = {0.3, 0.0}) {
    for (Duration t{}; t < time; t += period) step(command);
  }
};

TEST(Recovery, LeavesARobotAloneThatGetsOn) {
  Robot robot;
  for (int i = 0; i < 600; ++i) {
    robot.pose.x += 0.02;
    const Recovering recovering = robot.step({0.2, 0.0}, {20.0, 0.0});
    ASSERT_FALSE(recovering.twist);
    ASSERT_FALSE(recovering.begun) << recovering.why;
  }
}

TEST(Recovery, LeavesARobotAloneThatStandsAtItsTarget) {
  Robot robot;
  robot.pose = {9.7, 0.0, 0.0};
  robot.stand(120s, {});
  EXPECT_TRUE(robot.rungs.empty());
}

TEST(Recovery, TakesOneRungAfterTheOtherAndGivesUp) {
  Robot robot;
  robot.stand(3900ms);
  EXPECT_TRUE(robot.rungs.empty());
  robot.stand(200ms);
  EXPECT_EQ(robot.rungs, (std::vector{Rung::forget}));
  EXPECT_EQ(robot.why, "the robot stands though it has somewhere to go");
  robot.stand(60s);
  EXPECT_EQ(robot.rungs,
            (std::vector{Rung::forget, Rung::replan, Rung::turn, Rung::back_up, Rung::pull_ahead, Rung::give_up}));
  EXPECT_EQ(robot.why,
            "the robot stands though it has somewhere to go, and nothing has helped: forgetting, a new plan, turning, "
            "backing up, pulling ahead");
  robot.stand(600s);
  EXPECT_EQ(robot.rungs.size(), 6u) << "it stays out of the way";
  robot.recovery.begin();
  robot.stand(5s);
  EXPECT_EQ(robot.rungs.size(), 7u) << "another goal";
}

TEST(Recovery, LeavesOutWhatCannotHelp) {
  Robot robot;
  robot.room = in_a_corner();
  robot.stand(60s);
  EXPECT_EQ(robot.rungs, (std::vector{Rung::forget, Rung::replan, Rung::back_up, Rung::give_up})) << "no room to turn";
  Robot blind;
  blind.room = {};
  blind.stand(60s);
  EXPECT_EQ(blind.rungs, (std::vector{Rung::forget, Rung::replan, Rung::give_up})) << "nothing is seen";
}

TEST(Recovery, BeginsAnewOnceTheRobotIsFree) {
  Robot robot;
  robot.stand(8500ms);
  EXPECT_EQ(robot.rungs, (std::vector{Rung::forget, Rung::replan}));
  for (int i = 0; i < 80; ++i) {
    robot.pose.x += 0.02;
    robot.step({0.2, 0.0});
  }
  robot.rungs.clear();
  robot.stand(5s);
  EXPECT_EQ(robot.rungs, (std::vector{Rung::forget}));
}

TEST(Recovery, BoundsWhatOneGoalGets) {
  RecoveryParams params;
  params.most_rungs = 7;
  Robot robot(params);
  for (int round = 0; round < 50; ++round) {
    for (Duration t{}; t < 5s; t += period) robot.step({0.3, 0.0}, {1000.0, 0.0});
    for (int i = 0; i < 80; ++i) {
      robot.pose.x += 0.02;
      robot.step({0.2, 0.0}, {1000.0, 0.0});
    }
  }
  ASSERT_EQ(robot.rungs.size(), 8u);
  EXPECT_EQ(robot.rungs.back(), Rung::give_up);
  EXPECT_EQ(robot.why, "the robot stands though it has somewhere to go, again and again");
}

TEST(Recovery, NoticesThatItGoesRoundAndRoundOrToAndFro) {
  Robot circling;
  for (int i = 0; i < 400 && circling.rungs.empty(); ++i) {
    const double angle = 0.05 * i;
    circling.pose = {0.4 * std::cos(angle), 0.4 * std::sin(angle), geometry::wrap_angle(angle + 0.5 * pi)};
    circling.step({0.2, 0.5});
  }
  EXPECT_EQ(circling.why, "the robot does not get out of a small area");
  Robot swinging;
  for (int i = 0; i < 40; ++i) {
    swinging.pose.yaw = i % 2 == 0 ? 0.3 : -0.3;
    swinging.step({0.0, i % 2 == 0 ? -0.8 : 0.8});
  }
  EXPECT_EQ(swinging.why, "the robot goes to and fro");
}

TEST(Recovery, FollowsTheWallOfATrapUntilItsTargetIsAheadAgain) {
  Robot robot;
  robot.room.left = 0.6;
  for (int i = 0; i < 2000; ++i) {
    // Along a wall at its left, away from the target; what it is to back up does not help.
    robot.pose = {-0.005 * i, 0.0, pi};
    robot.step({0.05, 0.0});
    while (robot.recovery.manoeuvre() == Rung::back_up) robot.step({0.05, 0.0});
    if (robot.recovery.manoeuvre() == Rung::follow_wall) break;
  }
  ASSERT_EQ(robot.recovery.manoeuvre(), Rung::follow_wall);
  EXPECT_EQ(robot.why, "the robot drives away from its target");
  Recovering recovering = robot.step({});
  ASSERT_TRUE(recovering.twist);
  EXPECT_GT(recovering.twist->linear, 0.0);
  EXPECT_GT(recovering.twist->angular, 0.0) << "the wall is a little far";
  robot.room.ahead = 0.2;
  recovering = robot.step({});
  EXPECT_EQ(recovering.twist->linear, 0.0);
  EXPECT_LT(recovering.twist->angular, 0.0) << "away from the wall";
  robot.room.ahead = 2.0;
  robot.pose.yaw = 0.0;
  for (int i = 0; i < 40; ++i) recovering = robot.step({});
  EXPECT_TRUE(recovering.twist) << "its target is ahead, but it is no nearer to it than it was";
  robot.pose.x = 1.0;
  recovering = robot.step({});
  EXPECT_FALSE(recovering.twist);
}

TEST(Recovery, DoesNotBeginAnewBeforeItIsNearerThanEver) {
  Robot robot;
  robot.stand(8500ms);
  for (int i = 0; i < 80; ++i) {
    robot.pose.x -= 0.02;
    robot.step({-0.2, 0.0});
  }
  robot.rungs.clear();
  robot.stand(5s);
  ASSERT_FALSE(robot.rungs.empty());
  EXPECT_NE(robot.rungs.front(), Rung::forget) << "it is 1.6 m from where it was trapped, and farther from its target";
}

TEST(Recovery, LooksAroundFromTimeToTimeWhileThereIsNoWay) {
  Robot robot;
  double turned = 0.0;
  int looks = 0;
  for (int i = 0; i < 900; ++i) {
    robot.now += period;
    const Recovering recovering = robot.recovery.step(robot.now, robot.pose, std::nullopt, {}, robot.room);
    if (recovering.begun) {
      EXPECT_EQ(*recovering.begun, Rung::look_around);
      EXPECT_EQ(recovering.why, "the robot has no way to its goal");
      if (looks++ == 0) {
        EXPECT_EQ(robot.now, Time{} + 4100ms);
      }
    }
    if (!recovering.twist) continue;
    EXPECT_EQ(recovering.twist->linear, 0.0);
    turned += 0.1 * recovering.twist->angular;
    robot.pose.yaw = geometry::wrap_angle(robot.pose.yaw + 0.1 * recovering.twist->angular);
  }
  EXPECT_EQ(looks, 6);
  EXPECT_NEAR(turned, looks * 2.0 * pi, looks * 0.1);
  EXPECT_FALSE(robot.recovery.manoeuvre());
}

TEST(Recovery, LooksAroundNoLongerThanThereIsNoWay) {
  Robot robot;
  for (int i = 0; i < 60; ++i) {
    robot.now += period;
    robot.recovery.step(robot.now, robot.pose, std::nullopt, {}, robot.room);
  }
  ASSERT_EQ(robot.recovery.manoeuvre(), Rung::look_around);
  EXPECT_FALSE(robot.step({0.3, 0.0}).twist);
  EXPECT_FALSE(robot.recovery.manoeuvre());
  Robot cramped;
  cramped.room = in_a_corner();
  for (int i = 0; i < 600; ++i) {
    cramped.now += period;
    EXPECT_FALSE(cramped.recovery.step(cramped.now, cramped.pose, std::nullopt, {}, cramped.room).begun);
  }
}

TEST(Recovery, DrivesIntoNothing) {
  Robot robot;
  robot.stand(17s);
  ASSERT_EQ(robot.rungs.back(), Rung::turn);
  while (robot.recovery.manoeuvre() != Rung::back_up) robot.step({0.3, 0.0});
  EXPECT_LT(robot.step({0.3, 0.0}).twist->linear, 0.0);
  robot.room.behind = 0.05;
  EXPECT_EQ(robot.step({0.3, 0.0}).twist->linear, 0.0) << "something came up behind";
  for (int i = 0; i < 11; ++i) robot.step({0.3, 0.0});
  EXPECT_FALSE(robot.recovery.manoeuvre()) << "it waits for a second";
}

TEST(RoomFinder, TellsWhatIsBesideTheHullFromWhatIsBeforeIt) {
  RoomFinder finder({.front = 0.3, .rear = 0.3, .half_width = 0.2});
  finder.add({0.0, 0.0, 0.0}, 2.0, true);
  finder.add({0.2, 0.1, 0.5 * pi}, 0.11, true);  // 0.01 m beside its front
  const Room room = finder.room();
  EXPECT_NEAR(room.ahead, 1.7, 1e-9);
  EXPECT_NEAR(room.left, std::hypot(0.2, 0.21), 1e-9);
  EXPECT_NEAR(room.left_bearing, std::atan2(0.21, 0.2), 1e-9);
  EXPECT_NEAR(room.right_bearing, -0.5 * pi, 1e-9);
}

TEST(RoomFinder, KnowsOnlyWhereBeamsLook) {
  RoomFinder finder({.front = 0.2, .rear = 0.3, .half_width = 0.2});
  finder.add({0.1, 0.0, 0.0}, 1.0, true);
  finder.add({0.1, 0.0, 0.4}, 1.0, true);
  finder.add({0.0, 0.1, 0.5 * pi}, 5.0, false);
  finder.add({0.0, -0.1, -0.5 * pi}, 0.4, true);
  finder.add({0.0, -0.1, -2.0}, std::nan(""), true);
  const Room room = finder.room();
  EXPECT_NEAR(room.ahead, 0.9, 1e-9);
  EXPECT_TRUE(std::isnan(room.behind));
  EXPECT_GE(room.left, 5.0);
  EXPECT_NEAR(room.right, 0.5, 1e-9);
  EXPECT_NEAR(room.around, 0.5, 1e-9);
}

}  // namespace
}  // namespace kervan::control
