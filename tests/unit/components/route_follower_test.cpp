#include "components/control/route_follower.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace kervan::control {
namespace {

using geometry::Vector2;

RouteFollower on_route(std::vector<Vector2> route) {
  RouteFollower follower({});
  follower.start(std::move(route));
  return follower;
}

TEST(RouteFollower, HasNothingToDoWithoutARoute) {
  RouteFollower follower({});
  EXPECT_FALSE(follower.waypoint());
  EXPECT_FALSE(follower.advance({0, 0}));
  EXPECT_FALSE(follower.arrived());
}

TEST(RouteFollower, PassesAnIntermediateWaypointAtHalfAMetre) {
  auto follower = on_route({{2, 0}, {4, 0}});
  EXPECT_FALSE(follower.advance({1.49, 0}));
  EXPECT_EQ(follower.waypoint(), Vector2(2, 0));
  EXPECT_TRUE(follower.advance({1.5, 0}));
  EXPECT_EQ(follower.waypoint(), Vector2(4, 0));
  EXPECT_EQ(follower.index(), 1u);
}

TEST(RouteFollower, ReachesTheLastWaypointAtThreeCentimetresOnly) {
  auto follower = on_route({{4, 0}});
  EXPECT_FALSE(follower.advance({3.96, 0}));
  EXPECT_TRUE(follower.advance({3.975, 0}));
  EXPECT_TRUE(follower.arrived());
  EXPECT_EQ(follower.waypoint(), Vector2(4, 0));
}

TEST(RouteFollower, PassesByTheDistancesOfTheMomentWhenTheyChange) {
  auto follower = on_route({{2, 0}, {4, 0}});
  EXPECT_FALSE(follower.advance({1.0, 0}));
  follower.set_params({.pass_within = 1.0, .arrive_within = 0.5});
  EXPECT_TRUE(follower.advance({1.0, 0}));
  EXPECT_TRUE(follower.advance({3.5, 0}));
  EXPECT_TRUE(follower.arrived());
}

TEST(RouteFollower, PassesSeveralWaypointsThatLieClose) {
  auto follower = on_route({{0, 0}, {0.3, 0}, {0.4, 0.2}, {5, 0}});
  EXPECT_TRUE(follower.advance({0, 0}));
  EXPECT_EQ(follower.index(), 3u);
}

TEST(RouteFollower, NeverGoesBackToAPassedWaypoint) {
  auto follower = on_route({{0, 0}, {2, 0}, {4, 0}});
  follower.advance({0, 0});
  follower.advance({2, 0});
  EXPECT_EQ(follower.index(), 2u);
  follower.advance({0, 0});
  EXPECT_EQ(follower.index(), 2u);
}

TEST(RouteFollower, JoinsARouteWhereItPassesNearest) {
  auto follower = on_route({{0, 0}, {4, 0}, {4, 4}, {8, 4}});
  follower.join({4.3, 2.0});
  EXPECT_EQ(follower.index(), 2u) << "on its way to the third waypoint";
  follower.join({1.0, 0.0});
  EXPECT_EQ(follower.index(), 2u) << "what is passed stays passed";
}

TEST(RouteFollower, BeginsWithTheFirstWaypointWhenItStandsBeforeIt) {
  auto follower = on_route({{2, 0}, {4, 0}});
  follower.join({0, 0});
  EXPECT_EQ(follower.index(), 0u);
  follower.join({std::numeric_limits<double>::quiet_NaN(), 0.0});
  EXPECT_EQ(follower.index(), 0u);
  RouteFollower without({});
  without.join({0, 0});
  EXPECT_FALSE(without.waypoint());
}

TEST(RouteFollower, JoinsAWayThereAndBackOnTheWayThere) {
  auto follower = on_route({{0, 0}, {4, 0}, {0, 0}});
  follower.join({2, 0});
  EXPECT_EQ(follower.index(), 1u);
}

TEST(RouteFollower, StaysArrivedWhenTheRobotDriftsAway) {
  auto follower = on_route({{4, 0}});
  follower.advance({4, 0});
  EXPECT_FALSE(follower.advance({3, 0}));
  EXPECT_TRUE(follower.arrived());
}

TEST(RouteFollower, StartsAnewOnANewRoute) {
  auto follower = on_route({{4, 0}});
  follower.advance({4, 0});
  follower.start({{1, 0}, {2, 0}});
  EXPECT_FALSE(follower.arrived());
  EXPECT_EQ(follower.waypoint(), Vector2(1, 0));
  follower.start({});
  EXPECT_FALSE(follower.waypoint());
}

TEST(RouteFollower, PassesNothingFromAPositionThatIsNotFinite) {
  auto follower = on_route({{0, 0}, {4, 0}});
  EXPECT_FALSE(follower.advance({std::numeric_limits<double>::quiet_NaN(), 0}));
  EXPECT_EQ(follower.index(), 0u);
}

}  // namespace
}  // namespace kervan::control
