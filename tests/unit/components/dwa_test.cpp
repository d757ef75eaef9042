#include "components/control/dwa.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace kervan::control {
namespace {

using geometry::Pose2;
using geometry::Twist2;
using geometry::Vector2;
using Points = std::vector<SeenPoints::Point>;

constexpr double pi = std::numbers::pi;

/// Points every 4 cm.
void add_wall(Points& points, const Vector2& a, const Vector2& b) {
  const int pieces = static_cast<int>((b - a).norm() / 0.04) + 1;
  for (int i = 0; i <= pieces; ++i) points.push_back({a + static_cast<double>(i) / pieces * (b - a), {}});
}

double clearance(const geometry::RectangularHull& hull, const Pose2& robot, const Points& points) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& point : points) nearest = std::min(nearest, geometry::clearance(hull, robot.inverse() * point.at));
  return nearest;
}

/// A robot that follows commands with its accelerations, and hears of each one 50 ms after it was measured.
struct Driven {
  DwaParams params = {.delay = 0.05};
  Points points = {};
  Pose2 pose = {};
  Twist2 twist = {};
  double least_clearance = std::numeric_limits<double>::infinity();
  double fastest = 0.0;
  double slowest = 0.0;
  double time = 0.0;

  /// Until it is within 10 cm of the target, or `most` seconds have passed.
  bool reaches(const Vector2& target, double most) {
    DynamicWindow window(params);
    Twist2 commanded = {};
    while (time < most) {
      if ((target - pose.position()).norm() <= 0.1) return true;
      const Twist2 next = window.step({pose, twist}, target, points).twist;
      drive(commanded);
      commanded = next;
    }
    return false;
  }

  void drive(const Twist2& commanded) {
    constexpr double dt = 0.01;
    for (int i = 0; i < 5; ++i, time += dt) {
      const auto ramp = [&](double from, double to, double rate) {
        return from + std::clamp(to - from, -rate * dt, rate * dt);
      };
      twist.linear = ramp(twist.linear, commanded.linear, params.acceleration);
      twist.angular = ramp(twist.angular, commanded.angular, params.turn_acceleration);
      pose = pose * Pose2{twist.linear * dt, 0.0, twist.angular * dt};
      least_clearance = std::min(least_clearance, clearance(params.hull, pose, points));
      fastest = std::max(fastest, twist.linear);
      slowest = std::min(slowest, twist.linear);
    }
  }
};

TEST(Dwa, DrivesStraightAtFullSpeedWhereNothingIsInTheWay) {
  Driven robot;
  EXPECT_TRUE(robot.reaches({6.0, 0.0}, 10.0));
  EXPECT_NEAR(robot.fastest, robot.params.v_max, 0.01);
  EXPECT_LT(std::abs(robot.pose.y), 0.02);
  EXPECT_LT(robot.time, 6.0 / robot.params.v_max + 1.0);
}

TEST(Dwa, TurnsOnTheSpotToATargetBehindIt) {
  Driven robot;
  robot.params.v_back = 0.0;
  EXPECT_TRUE(robot.reaches({-3.0, 0.01}, 10.0));
  EXPECT_LT(robot.time, pi / robot.params.turn_rate + 3.0 / robot.params.v_max + 2.0);
}

TEST(Dwa, DrivesRoundAPillarOnItsWay) {
  Driven robot;
  for (int i = 0; i < 20; ++i)
    robot.points.push_back({Vector2(2.5, 0.02) + 0.15 * geometry::heading(i * pi / 10.0), {}});
  EXPECT_TRUE(robot.reaches({5.0, 0.0}, 20.0));
  EXPECT_GE(robot.least_clearance, robot.params.margin - 0.01);
}

TEST(Dwa, BrakesBeforeAWallThatItCannotPass) {
  Driven robot;
  robot.params.v_max = 2.0;
  add_wall(robot.points, {3.0, -4.0}, {3.0, 4.0});
  EXPECT_FALSE(robot.reaches({6.0, 0.0}, 15.0));
  EXPECT_GE(robot.least_clearance, robot.params.margin - 0.01);
  EXPECT_GT(robot.fastest, 1.0) << "it did drive at it";
}

TEST(Dwa, DrivesThroughADoorThatIsWideEnoughAndNotThroughANarrowerOne) {
  for (const bool wide : {true, false}) {
    Driven robot;
    robot.pose = {0.0, 0.1, 0.2};
    const double half = robot.params.hull.half_width + (wide ? 0.10 : 0.03);
    add_wall(robot.points, {1.5, half}, {1.5, 3.0});
    add_wall(robot.points, {1.5, -half}, {1.5, -3.0});
    EXPECT_EQ(robot.reaches({2.5, 0.0}, 15.0), wide);
    EXPECT_GE(robot.least_clearance, (wide ? robot.params.margin : 0.03) - 0.01) << wide;
  }
}

TEST(Dwa, BacksOutOfANicheInWhichItCannotTurn) {
  Driven robot;
  const double half = robot.params.hull.half_width + 0.08;
  add_wall(robot.points, {-0.3, half}, {0.4, half});
  add_wall(robot.points, {-0.3, -half}, {0.4, -half});
  add_wall(robot.points, {0.4, half}, {0.4, -half});
  EXPECT_TRUE(robot.reaches({-2.5, 0.5}, 20.0));
  EXPECT_LT(robot.slowest, -0.1);
  EXPECT_GE(robot.least_clearance, robot.params.margin - 0.015);
}

TEST(Dwa, WithoutDrivingBackwardItStaysInTheNiche) {
  Driven robot;
  robot.params.v_back = 0.0;
  const double half = robot.params.hull.half_width + 0.08;
  add_wall(robot.points, {-0.3, half}, {0.4, half});
  add_wall(robot.points, {-0.3, -half}, {0.4, -half});
  add_wall(robot.points, {0.4, half}, {0.4, -half});
  EXPECT_FALSE(robot.reaches({-2.5, 0.5}, 10.0));
  EXPECT_GE(robot.slowest, 0.0);
}

TEST(Dwa, NearerThanItsMarginItMovesAway) {
  Driven robot;
  add_wall(robot.points, {-1.0, 0.245}, {1.0, 0.245});  // 3 cm beside its left side
  EXPECT_TRUE(robot.reaches({2.0, -0.3}, 10.0));
  EXPECT_GE(robot.least_clearance, 0.02 - 0.005);
}

TEST(Dwa, MuchNearerItTurnsNoFurtherIn) {
  Driven robot;
  robot.params.v_back = 0.0;
  add_wall(robot.points, {-1.0, 0.23}, {1.0, 0.23});  // 1.5 cm beside its left side
  add_wall(robot.points, {0.275, -0.5}, {0.275, 0.23});
  EXPECT_FALSE(robot.reaches({-1.0, -1.0}, 10.0)) << "it would have to turn on the spot";
  EXPECT_GE(robot.least_clearance, 0.0149);
  EXPECT_NEAR(robot.pose.yaw, 0.0, 0.01);
}

TEST(Dwa, EnclosedItSaysThatNoMotionIsAdmissible) {
  DynamicWindow window({});
  Points points;
  for (const double x : {-0.30, 0.30}) add_wall(points, {x, -0.26}, {x, 0.26});
  for (const double y : {-0.26, 0.26}) add_wall(points, {-0.30, y}, {0.30, y});
  // It still has some room, but none that it could use: it would have to drive on into what it cannot brake before.
  const DwaStep step = window.step({{}, {1.0, 0.0}}, {3.0, 0.0}, points);
  EXPECT_EQ(step.outcome, Outcome::hindered);
  EXPECT_EQ(step.why, "no motion leaves room to brake");
  EXPECT_EQ(step.twist, Twist2{});
}

TEST(Dwa, ObeysItsLimitsAndItsWindow) {
  DwaParams params{.v_max = 1.0, .v_back = 0.2, .turn_rate = 1.5, .window = 0.2};
  DynamicWindow window(params);
  for (const double yaw : {0.0, 1.0, 2.0, 3.0, -1.0})
    for (const double v : {-0.2, 0.0, 0.5, 1.0}) {
      window.reset();
      const Twist2 twist = window.step({{0.0, 0.0, yaw}, {v, 0.0}}, {5.0, 0.0}, {}).twist;
      EXPECT_LE(twist.linear, params.v_max + 1e-6);
      EXPECT_GE(twist.linear, -params.v_back - 1e-6);
      EXPECT_LE(std::abs(twist.angular), params.turn_rate + 1e-6);
      EXPECT_LE(std::abs(twist.linear - v), params.acceleration * (params.window + params.delay) + 1e-6);
      EXPECT_LE(std::abs(twist.angular), params.turn_acceleration * (params.window + params.delay) + 1e-6);
    }
}

TEST(Dwa, WhatIsNotFiniteIsAFaultThatSaysWhat) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  DynamicWindow window({});
  const auto why = [&](const RobotState& robot, const Vector2& target) {
    const DwaStep step = window.step(robot, target, {});
    EXPECT_EQ(step.outcome, Outcome::fault);
    EXPECT_EQ(step.twist, Twist2{});
    return step.why;
  };
  EXPECT_EQ(why({{nan, 0.0, 0.0}, {}}, {1.0, 0.0}), "the pose is not finite");
  EXPECT_EQ(why({{}, {0.0, nan}}, {1.0, 0.0}), "the speed is not finite");
  EXPECT_EQ(why({{}, {}}, {1.0, nan}), "the target is not finite");
}

}  // namespace
}  // namespace kervan::control
