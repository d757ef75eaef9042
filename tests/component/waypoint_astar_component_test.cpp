#include <gtest/gtest.h>

#include "framework/test/harness.hpp"
#include "nav_msgs/msg/Path.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using nav_msgs::msg::Path;

ValueMap triangle() {
  return {{"nodes", points({{0, 0}, {4, 3}, {8, 0}, {20, 20}})}, {"edges", pairs({{0, 1}, {1, 2}})}};
}

std::string refusal_of(const ValueMap& parameters) {
  try {
    Harness harness("planning/waypoint_astar", parameters);
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(WaypointAstarComponent, PublishesTheWaypointsOnTheWay) {
  Harness harness("planning/waypoint_astar", triangle());
  harness.feed("odom", odometry_at({0.1, 0.0, 0.0}));
  harness.feed("goal", pose_at(8.0, 0.0));
  harness.advance(10ms);
  const auto* route = harness.latest<Path>("route");
  ASSERT_TRUE(route);
  ASSERT_EQ(route->poses.size(), 3u);
  EXPECT_EQ(route->header.frame_id, "map");
  EXPECT_EQ(route->poses[1].pose.position.x, 4.0);
  EXPECT_EQ(route->poses[1].pose.position.y, 3.0);
  EXPECT_EQ(route->poses[2].pose.orientation.w, 1.0);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(WaypointAstarComponent, WaitsForTheOdometryAndThenPlansOnce) {
  Harness harness("planning/waypoint_astar", triangle());
  harness.feed("goal", pose_at(8.0, 0.0));
  harness.advance(10ms);
  EXPECT_FALSE(harness.latest<Path>("route"));
  EXPECT_EQ(harness.state(), ComponentState::active) << "it may come any moment";
  harness.advance(100ms);
  EXPECT_EQ(harness.state(), ComponentState::degraded);
  EXPECT_EQ(harness.reason(), "odom: nothing received yet");
  for (int i = 0; i < 5; ++i) {
    harness.feed("odom", odometry_at({0.0, 0.0, 0.0}));
    harness.advance(50ms);
  }
  EXPECT_EQ(harness.take<Path>("route").size(), 1u);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(WaypointAstarComponent, EndsTheRouteAtTheGoalThoughItIsNoWaypoint) {
  Harness harness("planning/waypoint_astar", triangle());
  harness.feed("odom", odometry_at({0.0, 0.0, 0.0}));
  harness.feed("goal", pose_at(8.0, 0.5));
  harness.advance(10ms);
  const auto* route = harness.latest<Path>("route");
  ASSERT_TRUE(route);
  ASSERT_EQ(route->poses.size(), 4u);
  EXPECT_EQ(route->poses.back().pose.position.y, 0.5);
}

TEST(WaypointAstarComponent, SaysWhyThereIsNoRouteAndPublishesAnEmptyOne) {
  Harness harness("planning/waypoint_astar", triangle());
  harness.feed("odom", odometry_at({0.0, 0.0, 0.0}));
  harness.feed("goal", pose_at(20.0, 20.0));
  harness.advance(10ms);
  ASSERT_TRUE(harness.latest<Path>("route"));
  EXPECT_TRUE(harness.latest<Path>("route")->poses.empty());
  EXPECT_EQ(harness.reason(), "no route: no edges lead from the start to the goal");
  harness.feed("goal", pose_at(-5.0, 0.0));
  harness.advance(10ms);
  EXPECT_EQ(harness.reason(), "no route: no waypoint is within reach of the goal");
  harness.feed("goal", pose_at(8.0, 0.0));
  harness.advance(10ms);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(WaypointAstarComponent, RefusesEdgesThatCannotBe) {
  ValueMap parameters = triangle();
  parameters["edges"] = pairs({{0, 1}, {1, 4}});
  EXPECT_EQ(refusal_of(parameters), "subject.edges[1]: node 4 does not exist; there are 4 nodes, counted from 0");
  parameters["edges"] = pairs({{0, -1}});
  EXPECT_NE(refusal_of(parameters), "accepted");
  parameters["edges"] = pairs({{1, 1}});
  EXPECT_EQ(refusal_of(parameters), "subject.edges[0]: node 1 cannot be joined to itself");
}

TEST(WaypointAstarComponent, RefusesCostsThatDoNotFitTheEdges) {
  ValueMap parameters = triangle();
  parameters["costs"] = ValueList{9.0};
  EXPECT_EQ(refusal_of(parameters), "subject.costs: 1 costs for 2 edges; allowed: one for each, or none");
  parameters["costs"] = ValueList{9.0, 1.0};
  EXPECT_NE(refusal_of(parameters), "accepted") << "1 m is shorter than the edge";
}

}  // namespace
}  // namespace kervan::test
