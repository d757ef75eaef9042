#include <gtest/gtest.h>

#include "framework/test/harness.hpp"
#include "nav_msgs/msg/Path.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::PoseStamped;

nav_msgs::msg::Path route(std::initializer_list<std::pair<double, double>> list) {
  nav_msgs::msg::Path path;
  path.header.frame_id = "map";
  for (const auto& [x, y] : list) path.poses.push_back(pose_at(x, y));
  return path;
}

void be_at(Harness& harness, double x, double y) {
  harness.feed("odom", odometry_at({x, y, 0.0}));
  harness.advance(50ms);
}

TEST(RouteFollowerComponent, AsksForOneWaypointAfterTheOther) {
  Harness harness("control/route_follower");
  be_at(harness, 0.0, 0.0);
  harness.feed("route", route({{0, 0}, {2, 0}, {4, 0}}));
  harness.advance(10ms);
  const auto* waypoint = harness.latest<PoseStamped>("waypoint");
  ASSERT_TRUE(waypoint);
  EXPECT_EQ(waypoint->pose.position.x, 2.0) << "the robot stands on the first already";
  EXPECT_EQ(waypoint->header.frame_id, "map");
  be_at(harness, 1.4, 0.0);
  EXPECT_EQ(harness.latest<PoseStamped>("waypoint")->pose.position.x, 2.0);
  be_at(harness, 1.6, 0.0);
  EXPECT_EQ(harness.latest<PoseStamped>("waypoint")->pose.position.x, 4.0);
  EXPECT_EQ(harness.take<PoseStamped>("waypoint").size(), 2u);
}

TEST(RouteFollowerComponent, AsksToStayWhenTheRouteIsEmpty) {
  Harness harness("control/route_follower");
  harness.feed("route", route({{2, 0}, {4, 0}}));
  be_at(harness, 0.7, 0.1);
  harness.feed("route", route({}));
  harness.advance(10ms);
  const auto* waypoint = harness.latest<PoseStamped>("waypoint");
  ASSERT_TRUE(waypoint);
  EXPECT_EQ(waypoint->pose.position.x, 0.7);
  EXPECT_EQ(waypoint->pose.position.y, 0.1);
}

TEST(RouteFollowerComponent, AsksForNothingWithoutARoute) {
  Harness harness("control/route_follower");
  be_at(harness, 0.0, 0.0);
  EXPECT_FALSE(harness.latest<PoseStamped>("waypoint"));
}

TEST(RouteFollowerComponent, LooksAheadAndPublishesOnlyWhatMoves) {
  Harness harness("control/route_follower", {{"look_ahead", 1.0}});
  be_at(harness, 0.0, 0.0);
  harness.feed("route", route({{0, 0}, {4, 0}}));
  harness.advance(10ms);
  EXPECT_NEAR(harness.latest<PoseStamped>("waypoint")->pose.position.x, 1.0, 1e-9);
  be_at(harness, 0.4, 0.1);
  EXPECT_NEAR(harness.latest<PoseStamped>("waypoint")->pose.position.x, 1.4, 1e-9);
  harness.take<PoseStamped>("waypoint");
  be_at(harness, 0.4, 0.1);
  EXPECT_EQ(harness.take<PoseStamped>("waypoint").size(), 0u);
  harness.change_parameters({{"look_ahead", 2.0}});
  be_at(harness, 0.4, 0.1);
  EXPECT_NEAR(harness.latest<PoseStamped>("waypoint")->pose.position.x, 2.4, 1e-9);
}

}  // namespace
}  // namespace kervan::test
