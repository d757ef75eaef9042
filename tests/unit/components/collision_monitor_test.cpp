#include "components/safety/collision_monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace kervan::safety {
namespace {

using geometry::Twist2;
using geometry::Vector2;
using Points = std::vector<Vector2>;

const CollisionMonitorParams params{
    .stop_margin = 0.05, .slow_margin = 0.3, .slow_speed = 0.5, .time_to_collision = 0.5, .max_reverse = 0.3};
const CollisionMonitor monitor(params);
constexpr double front = geometry::RectangularHull{}.front;

TEST(CollisionMonitor, PassesWhatLeadsNowhereNearAnything) {
  const Checked checked = monitor.check({1.0, 0.5}, Points{{3.0, 0.0}, {0.0, 1.0}});
  EXPECT_EQ(checked.verdict, Verdict::passed);
  EXPECT_EQ(checked.twist, (Twist2{1.0, 0.5}));
  EXPECT_EQ(checked.why, "");
  EXPECT_EQ(monitor.check({2.0, 0.0}, Points{}).twist, (Twist2{2.0, 0.0}));
}

TEST(CollisionMonitor, SlowsDownByTheTimeThatRemains) {
  // The stop zone meets the point after 0.35 m, which takes 0.35 s of the 0.5 s that there should be.
  const Checked checked = monitor.check({1.0, 0.2}, Points{{front + 0.05 + 0.35, 0.0}});
  EXPECT_EQ(checked.verdict, Verdict::slowed);
  EXPECT_EQ(checked.why, "it would soon collide");
  EXPECT_NEAR(checked.time, 0.35, 0.021);
  EXPECT_NEAR(checked.twist.linear, 0.7, 0.05);
  EXPECT_NEAR(checked.twist.angular / checked.twist.linear, 0.2, 1e-9) << "along the same arc";
}

TEST(CollisionMonitor, StopsBeforeWhatIsAtItsStopZone) {
  const Checked checked = monitor.check({1.0, 0.0}, Points{{front + 0.055, 0.1}});
  EXPECT_EQ(checked.verdict, Verdict::stopped);
  EXPECT_EQ(checked.why, "it would collide");
  EXPECT_EQ(checked.twist, Twist2{});
}

TEST(CollisionMonitor, HasMoreTimeOnAnArcThatLeadsPast) {
  const Points post{{0.6, 0.26}};
  EXPECT_EQ(monitor.check({1.0, 0.0}, post).verdict, Verdict::slowed);
  EXPECT_EQ(monitor.check({1.0, -1.0}, post).verdict, Verdict::passed);
  EXPECT_EQ(monitor.check({1.0, 1.0}, post).verdict, Verdict::slowed);
}

TEST(CollisionMonitor, AlsoTurningOnTheSpotMayCollide) {
  const Points beside_the_nose{{0.25, 0.27}};  // the corner would sweep over it
  EXPECT_NE(monitor.check({0.0, 1.5}, beside_the_nose).verdict, Verdict::passed);
  EXPECT_EQ(monitor.check({0.0, 1.5}, Points{{0.0, 0.45}}).verdict, Verdict::passed);
}

TEST(CollisionMonitor, SlowsDownWithSomethingInTheSlowZone) {
  const Points beside{{0.0, 0.4}};
  const Checked checked = monitor.check({1.0, 0.0}, beside);
  EXPECT_EQ(checked.verdict, Verdict::slowed);
  EXPECT_EQ(checked.why, "something is in the slow zone");
  EXPECT_NEAR(checked.twist.linear, 0.5, 1e-9);
  EXPECT_EQ(monitor.check({0.4, 0.0}, beside).verdict, Verdict::passed);
}

TEST(CollisionMonitor, LetsARobotDriveAwayFromWhatIsTooNear) {
  const Points ahead{{front + 0.02, 0.0}};  // in the stop zone
  EXPECT_EQ(monitor.check({0.2, 0.0}, ahead).verdict, Verdict::stopped);
  EXPECT_EQ(monitor.check({-0.2, 0.0}, ahead).verdict, Verdict::passed);
  EXPECT_EQ(monitor.check({}, ahead).verdict, Verdict::passed) << "standing is no collision";
}

TEST(CollisionMonitor, APointInsideOfTheHullIsDrivenAwayFromToo) {
  const Points inside{{front - 0.02, 0.0}};
  EXPECT_EQ(monitor.check({0.2, 0.0}, inside).verdict, Verdict::stopped);
  EXPECT_EQ(monitor.check({-0.2, 0.0}, inside).verdict, Verdict::passed);
}

TEST(CollisionMonitor, DrivesBackwardSlowly) {
  const Checked checked = monitor.check({-1.0, 0.4}, Points{});
  EXPECT_EQ(checked.verdict, Verdict::slowed);
  EXPECT_EQ(checked.why, "it drives backward");
  EXPECT_NEAR(checked.twist.linear, -0.3, 1e-9);
  EXPECT_NEAR(checked.twist.angular, 0.12, 1e-9);
}

TEST(CollisionMonitor, StopsACommandThatIsNotFinite) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Twist2& wanted : {Twist2{nan, 0.0}, Twist2{0.0, nan}}) {
    const Checked checked = monitor.check(wanted, Points{});
    EXPECT_EQ(checked.verdict, Verdict::stopped);
    EXPECT_EQ(checked.why, "the command is not finite");
    EXPECT_EQ(checked.twist, Twist2{});
  }
}

TEST(CollisionMonitor, ARobotThatKeepsOnDrivingAtAWallComesToRestBeforeIt) {
  for (const double v : {0.3, 0.45}) {
    double x = 0.0, last = v;
    for (int i = 0; i < 200; ++i) {  // 10 s at 20 Hz
      last = monitor.check({v, 0.0}, Points{{1.0 - x, 0.0}}).twist.linear;
      x += last * 0.05;
    }
    EXPECT_EQ(last, 0.0) << v;
    EXPECT_GE(1.0 - x - front, params.stop_margin - 1e-6) << v;
    EXPECT_LT(1.0 - x - front, params.stop_margin + 0.05) << v;
  }
}

}  // namespace
}  // namespace kervan::safety
