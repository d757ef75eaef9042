#include "components/control/pursuit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace kervan::control {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(HeadingDrive, IsFullSpeedStraightAhead) {
  EXPECT_EQ(drive_in_direction({}, 0.0, 9.0), (geometry::Twist2{0.6, 0.0}));
}

TEST(HeadingDrive, IsSlowerTheMoreItHasToTurn) {
  EXPECT_NEAR(drive_in_direction({}, 0.3, 9.0).linear, 0.6 * std::cos(0.3), 1e-12);
  EXPECT_NEAR(drive_in_direction({}, -0.3, 9.0).angular, -0.6, 1e-12);
  EXPECT_EQ(drive_in_direction({}, 0.81, 9.0), (geometry::Twist2{0.0, 0.75})) << "on the spot";
  EXPECT_EQ(drive_in_direction({.turn_on_spot = pi}, pi, 9.0).linear, 0.0) << "never backwards";
}

TEST(HeadingDrive, CanStandInTime) {
  EXPECT_NEAR(drive_in_direction({}, 0.0, 0.09).linear, 0.3, 1e-12);
  EXPECT_EQ(drive_in_direction({}, 0.0, -0.1).linear, 0.0);
  EXPECT_NEAR(stopping_speed(0.25, 0.5), 0.5, 1e-12);
  EXPECT_EQ(stopping_speed(0.0, 0.5, 0.2), 0.0);
  const double v = stopping_speed(0.4, 0.5, 0.2);
  EXPECT_NEAR(v * 0.2 + v * v / (2.0 * 0.5), 0.4, 1e-12) << "the way before it brakes, and that of braking";
}

TEST(Pursuit, DrivesStraightAtTheTarget) {
  const Steering ahead = pursue({}, {{1.0, 2.0, pi / 2}}, {1.0, 9.0});
  EXPECT_EQ(ahead.outcome, Outcome::drives);
  EXPECT_NEAR(ahead.twist.linear, 0.6, 1e-12);
  EXPECT_NEAR(ahead.twist.angular, 0.0, 1e-12);
  EXPECT_GT(pursue({}, {}, {5.0, 1.0}).twist.angular, 0.0);
  EXPECT_LT(pursue({}, {}, {5.0, -1.0}).twist.angular, 0.0);
}

TEST(Pursuit, TurnsOnTheSpotTowardsWhatLiesBehind) {
  EXPECT_EQ(pursue({}, {}, {-5.0, -1.0}).twist, (geometry::Twist2{0.0, -0.75}));
}

TEST(Pursuit, ComesToRestOnTheTarget) {
  EXPECT_EQ(pursue({}, {}, {0.0, 0.0}).twist, geometry::Twist2{});
  EXPECT_NEAR(pursue({}, {}, {0.01, 0.0}).twist.linear, 0.1, 1e-12);
}

TEST(Pursuit, RefusesWhatIsNotFinite) {
  EXPECT_EQ(pursue({}, {{nan, 0.0, 0.0}}, {1.0, 0.0}).why, "the pose is not finite");
  EXPECT_EQ(pursue({}, {{}, {0.0, nan}}, {1.0, 0.0}).why, "the speed is not finite");
  const Steering steering = pursue({}, {}, {1.0, nan});
  EXPECT_EQ(steering.why, "the target is not finite");
  EXPECT_EQ(steering.outcome, Outcome::fault);
  EXPECT_EQ(steering.twist, geometry::Twist2{});
}

}  // namespace
}  // namespace kervan::control
