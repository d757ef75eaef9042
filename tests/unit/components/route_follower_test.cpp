#include "components/control/route_follower.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <utility>
#include <vector>

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

RouteFollower looking_ahead(double look_ahead, double cut_corners, std::vector<Vector2> route) {
  RouteFollower follower({.look_ahead = look_ahead, .cut_corners = cut_corners});
  follower.start(std::move(route));
  return follower;
}

void expect_near(const std::optional<Vector2>& point, const Vector2& wanted) {
  ASSERT_TRUE(point);
  EXPECT_NEAR(point->x(), wanted.x(), 1e-3);
  EXPECT_NEAR(point->y(), wanted.y(), 1e-3);
}

TEST(RouteFollower, LooksAheadAlongTheRouteFromWhereItIsNearest) {
  auto follower = looking_ahead(1.0, 0.1, {{0, 0}, {4, 0}});
  EXPECT_TRUE(follower.advance({0.5, 0.05}));
  expect_near(follower.waypoint(), {1.5, 0});
  EXPECT_TRUE(follower.advance({0.6, 0.05}));
  expect_near(follower.waypoint(), {1.6, 0});
  EXPECT_FALSE(follower.advance({0.6, 0.05})) << "it stands, and so does the point";
}

TEST(RouteFollower, LooksPastWaypointsThatLieNearTheLine) {
  auto follower = looking_ahead(2.0, 0.1, {{0, 0}, {1, 0.05}, {4, 0.05}});
  follower.advance({0, 0});
  EXPECT_GT(follower.waypoint()->x(), 1.9);
}

TEST(RouteFollower, DoesNotLookRoundACorner) {
  auto follower = looking_ahead(2.0, 0.1, {{0, 0}, {1, 0}, {1, 3}});
  follower.advance({0, 0});
  // The line from (0, 0) to (1, y) passes the corner (1, 0) at 0.1 m where y / sqrt(1 + y^2) = 0.1.
  expect_near(follower.waypoint(), {1.0, 0.1005});
  follower.advance({0.95, 0.0});
  EXPECT_GT(follower.waypoint()->y(), 1.5) << "at the corner it sees along the other leg";
}

TEST(RouteFollower, LooksNoFartherThanTheEnd) {
  auto follower = looking_ahead(1.0, 0.1, {{0, 0}, {4, 0}});
  follower.advance({3.5, 0});
  expect_near(follower.waypoint(), {4, 0});
  EXPECT_FALSE(follower.arrived());
  EXPECT_TRUE(follower.advance({3.98, 0}));
  EXPECT_TRUE(follower.arrived());
}

TEST(RouteFollower, LookingAheadItStaysOnItsPartOfTheRoute) {
  // There and back again, 0.3 m apart.
  auto follower = looking_ahead(1.0, 0.1, {{0, 0}, {5, 0}, {5, 0.3}, {0, 0.3}});
  follower.advance({1.0, 0.2});
  expect_near(follower.waypoint(), {2.0, 0});
  EXPECT_EQ(follower.index(), 1u);
}

TEST(RouteFollower, LookingAheadItNeverGoesBack) {
  auto follower = looking_ahead(1.0, 0.1, {{0, 0}, {2, 0}, {2, 2}});
  follower.advance({2.0, 1.0});
  EXPECT_EQ(follower.index(), 1u) << "beyond what it looks at";
  follower.advance({1.8, 0.0});
  follower.advance({2.0, 0.5});
  EXPECT_EQ(follower.index(), 2u);
  follower.advance({1.0, 0.0});
  EXPECT_EQ(follower.index(), 2u);
}

}  // namespace
}  // namespace kervan::control
