#include "components/control/potential_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kervan::control {
namespace {

using geometry::Vector2;

constexpr double pi = std::numbers::pi;

ForceParams classical() { return {.law = ForceLaw::classical}; }
ForceParams ge_cui() { return {.law = ForceLaw::ge_cui}; }

/// The force on a robot at the origin whose goal lies `rho_g` ahead and whose obstacle lies `rho` ahead.
Force force_ahead(const ForceParams& params, double rho_g, double rho) {
  return force_at(params, {0.0, 0.0}, {rho_g, 0.0}, Vector2(rho, 0.0));
}

/// Where a robot comes to rest that follows the force along the normal of a wall `g` behind the goal: its distance from
/// the goal.
double rest_offset(const ForceParams& params, double g) {
  Vector2 robot(-2.0, 0.0);
  for (int i = 0; i < 20000; ++i) robot.x() += 0.005 * force_at(params, robot, {0.0, 0.0}, Vector2(g, 0.0)).total.x();
  return -robot.x();
}

/// The distance from an obstacle between robot and goal at which attraction and repulsion are equal, `rho_g` from the
/// goal.
double stand_off(const ForceParams& params, double rho_g) {
  double near = 0.01, far = params.rho0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (near + far);
    (force_ahead(params, rho_g, middle).total.x() < 0.0 ? near : far) = middle;
  }
  return near;
}

TEST(PotentialField, HasThePapersTermsOfGeAndCui) {
  const Force force = force_ahead(ge_cui(), 1.0, 0.5);
  EXPECT_DOUBLE_EQ(force.f1, 1.2);
  EXPECT_DOUBLE_EQ(force.f2, 0.45);
  EXPECT_NEAR(force.repulsion.x(), 0.45 - 1.2, 1e-12);
  EXPECT_NEAR(force.attraction.x(), 1.0, 1e-12);
  EXPECT_NEAR(force.total.x(), 1.0 + 0.45 - 1.2, 1e-12);
}

TEST(PotentialField, HasNoRepulsionOfGeAndCuiAtTheGoal) {
  const Force force = force_ahead(ge_cui(), 0.0, 0.5);
  EXPECT_EQ(force.f1, 0.0);
  EXPECT_EQ(force.f2, 0.0);
  EXPECT_EQ(force.total, Vector2(0.0, 0.0));
}

TEST(PotentialField, RepelsClassicallyWhateverTheDistanceOfTheGoal) {
  for (const double rho_g : {0.0, 0.2, 1.0, 6.8}) {
    const Force force = force_ahead(classical(), rho_g, 0.5);
    EXPECT_DOUBLE_EQ(force.f1, 1.2) << rho_g;
    EXPECT_EQ(force.f2, 0.0) << rho_g;
  }
}

TEST(PotentialField, IsClassicalWhenTheExponentIsZero) {
  ForceParams params = ge_cui();
  params.n = 0.0;
  EXPECT_EQ(force_ahead(params, 2.0, 0.4).total, force_ahead(classical(), 2.0, 0.4).total);
}

TEST(PotentialField, PushesAwayFromTheObstacleAndTowardsTheGoal) {
  const Force force = force_at(ge_cui(), {0.0, 0.0}, {1.0, 0.0}, Vector2(0.0, 0.5));
  EXPECT_NEAR(force.repulsion.x(), 0.45, 1e-12);
  EXPECT_NEAR(force.repulsion.y(), -1.2, 1e-12);
}

TEST(PotentialField, IgnoresAnObstacleBeyondItsInfluence) {
  EXPECT_EQ(force_ahead(classical(), 1.0, 1.0).repulsion, Vector2(0.0, 0.0));
  EXPECT_EQ(force_ahead(classical(), 1.0, 1.5).repulsion, Vector2(0.0, 0.0));
  EXPECT_GT(force_ahead(classical(), 1.0, 0.99).f1, 0.0);
}

TEST(PotentialField, IsPureAttractionWithoutAnObstacle) {
  const Force force = force_at(ge_cui(), {1.0, 1.0}, {1.0, 1.4}, std::nullopt);
  EXPECT_FALSE(force.rho);
  EXPECT_NEAR(force.total.x(), 0.0, 1e-12);
  EXPECT_NEAR(force.total.y(), 0.4, 1e-12);
}

TEST(PotentialField, AttractsNoMoreBeyondTheCap) {
  EXPECT_DOUBLE_EQ(force_at(ge_cui(), {0.0, 0.0}, {6.8, 0.0}, std::nullopt).attraction.norm(), 1.0);
  EXPECT_DOUBLE_EQ(force_ahead(ge_cui(), 6.8, 0.5).f1, 1.2);
  EXPECT_DOUBLE_EQ(force_ahead(ge_cui(), 6.8, 0.5).f2, 0.45);
}

TEST(PotentialField, StaysFiniteOnTheObstaclePoint) {
  const Force force = force_at(ge_cui(), {0.0, 0.0}, {1.0, 0.0}, Vector2(0.0, 0.0));
  EXPECT_TRUE(force.total.allFinite());
  EXPECT_EQ(drive_along({}, force, 0.0).linear, 0.0);
}

struct RestPoint {
  double rho0, g, offset;
};

class ClassicalRestPoint : public testing::TestWithParam<RestPoint> {};

TEST_P(ClassicalRestPoint, LiesWhereTheTableSays) {
  ForceParams params = classical();
  params.rho0 = GetParam().rho0;
  EXPECT_NEAR(rest_offset(params, GetParam().g), GetParam().offset, 0.0006);
}

INSTANTIATE_TEST_SUITE_P(
    PotentialField, ClassicalRestPoint,
    testing::Values(RestPoint{0.5, 0.1, .348}, RestPoint{0.5, 0.2, .258}, RestPoint{0.5, 0.3, .170},
                    RestPoint{0.5, 0.4, .084}, RestPoint{0.5, 0.5, 0.0}, RestPoint{0.5, 0.8, 0.0},
                    RestPoint{1.0, 0.1, .511}, RestPoint{1.0, 0.2, .433}, RestPoint{1.0, 0.3, .359},
                    RestPoint{1.0, 0.4, .288}, RestPoint{1.0, 0.5, .222}, RestPoint{1.0, 0.8, .064},
                    RestPoint{1.5, 0.1, .566}, RestPoint{1.5, 0.2, .491}, RestPoint{1.5, 0.3, .419},
                    RestPoint{1.5, 0.4, .352}, RestPoint{1.5, 0.5, .289}, RestPoint{1.5, 0.8, .137},
                    RestPoint{2.0, 0.1, .592}, RestPoint{2.0, 0.2, .518}, RestPoint{2.0, 0.3, .448},
                    RestPoint{2.0, 0.4, .382}, RestPoint{2.0, 0.5, .320}, RestPoint{2.0, 0.8, .170}),
    [](const auto& rest) {
      const auto tenths = [](double metres) { return std::to_string(std::lround(10.0 * metres)); };
      return "Influence" + tenths(rest.param.rho0) + "dmWall" + tenths(rest.param.g) + "dm";
    });

TEST(PotentialField, ReachesAGoalCloseToAWallWithGeAndCui) {
  for (const double g : {0.1, 0.2, 0.4, 0.8}) EXPECT_NEAR(rest_offset(ge_cui(), g), 0.0, 1e-6) << g;
}

TEST(PotentialField, StandsOffAnObstacleAsTheTableSaysWithoutTheCap) {
  ForceParams params = ge_cui();
  params.rho_g_cap = 1e9;
  const double rho_g[] = {0.5, 1.0, 2.6, 4.5, 6.8};
  const double wide[] = {0.28, 0.47, 0.76, 0.88, 0.94}, narrow[] = {0.28, 0.39, 0.47, 0.49, 0.50};
  for (int i = 0; i < 5; ++i) {
    params.rho0 = 1.0;
    EXPECT_NEAR(stand_off(params, rho_g[i]), wide[i], 0.006) << rho_g[i];
    params.rho0 = 0.5;
    EXPECT_NEAR(stand_off(params, rho_g[i]), narrow[i], 0.006) << rho_g[i];
  }
}

TEST(PotentialField, StandsOffAnObstacleEquallyEverywhereWithTheCap) {
  for (const double rho_g : {1.0, 2.6, 6.8}) EXPECT_NEAR(stand_off(ge_cui(), rho_g), 0.47, 0.006) << rho_g;
}

Force pull(double x, double y) {
  Force force;
  force.total = {x, y};
  return force;
}

TEST(ForceDrive, DrivesAtFullSpeedAlongAStrongForceAhead) {
  EXPECT_EQ(drive_along({}, pull(3.0, 0.0), 0.0), (geometry::Twist2{0.5, 0.0}));
}

TEST(ForceDrive, DrivesSlowerAlongAWeakForce) {
  EXPECT_DOUBLE_EQ(drive_along({}, pull(0.0, 0.3), pi / 2).linear, 0.15);
}

TEST(ForceDrive, TurnsOnTheSpotWhenTheForceIsBehind) {
  const auto twist = drive_along({}, pull(-1.0, 0.1), 0.0);
  EXPECT_EQ(twist.linear, 0.0);
  EXPECT_EQ(twist.angular, 1.0);
  EXPECT_EQ(drive_along({}, pull(-1.0, -0.1), 0.0).angular, -1.0);
}

TEST(ForceDrive, SlowsDownWithTheCosineAndTurnsWithTheAngle) {
  const auto twist = drive_along({}, pull(std::cos(0.4), std::sin(0.4)), 0.0);
  EXPECT_NEAR(twist.linear, 0.5 * std::cos(0.4), 1e-12);
  EXPECT_NEAR(twist.angular, 0.8, 1e-12);
}

TEST(ForceDrive, TurnsTheShortWayAcrossTheBackwardDirection) {
  const auto twist = drive_along({}, pull(std::cos(-3.0), std::sin(-3.0)), 3.0);
  EXPECT_NEAR(twist.angular, 2.0 * (2.0 * pi - 6.0), 1e-9);
}

TEST(ForceDrive, StandsWithoutAForce) { EXPECT_EQ(drive_along({}, pull(0.0, 0.0), 1.0), geometry::Twist2{}); }

TEST(ForceDrive, CanAlwaysStopBeforeTheObstacle) {
  Force force = pull(1.0, 0.0);
  force.rho = 0.30;
  EXPECT_EQ(drive_along({}, force, 0.0).linear, 0.0);
  force.rho = 0.34;
  EXPECT_NEAR(drive_along({}, force, 0.0).linear, 0.2, 1e-12);
  force.rho = 2.0;
  EXPECT_EQ(drive_along({}, force, 0.0).linear, 0.5);
}

}  // namespace
}  // namespace kervan::control
