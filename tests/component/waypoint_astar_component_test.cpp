#include <gtest/gtest.h>

#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "nav_msgs/msg/Path.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using kervan_msgs::msg::GoalState;
using kervan_msgs::msg::GoalStatus;
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
  harness.advance(300ms);
  ASSERT_TRUE(harness.latest<Path>("route"));
  EXPECT_TRUE(harness.latest<Path>("route")->poses.empty());
  EXPECT_EQ(harness.reason(), "no route: no edges lead from the start to the goal");
  harness.feed("goal", pose_at(-5.0, 0.0));
  harness.advance(300ms);
  EXPECT_EQ(harness.reason(), "no route: no waypoint is within reach of the goal");
  harness.feed("goal", pose_at(8.0, 0.0));
  harness.advance(300ms);
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

/// As pose_at(), stamped.
geometry_msgs::msg::PoseStamped goal_at(double x, double y, Duration stamp) {
  auto goal = pose_at(x, y);
  goal.header.stamp = geometry::to_message(Time(stamp));
  return goal;
}

TEST(WaypointAstarComponent, SaysWhatBecomesOfTheGoal) {
  Harness harness("planning/waypoint_astar", triangle());
  harness.feed("goal", goal_at(8.0, 0.0, 2s + 5ms));
  harness.advance(10ms);
  const auto* status = harness.latest<GoalStatus>("goal_status");
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state, GoalState::GOAL_PENDING);
  EXPECT_EQ(status->goal_id, "2.005000000");
  EXPECT_TRUE(std::isnan(status->distance));
  harness.feed("odom", odometry_at({0.0, 0.0, 0.0}));
  harness.advance(10ms);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_ACTIVE);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->distance, 8.0);
  harness.feed("odom", odometry_at({7.69, 0.0, 0.0}));
  harness.advance(10ms);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_ACTIVE);
  harness.feed("odom", odometry_at({7.71, 0.0, 0.0}));
  harness.advance(10ms);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_REACHED);
  harness.feed("odom", odometry_at({4.0, 3.0, 0.0}));
  harness.advance(10ms);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_REACHED) << "it stays that";
}

TEST(WaypointAstarComponent, SaysThatAGoalHasFailedOrWasReplaced) {
  Harness harness("planning/waypoint_astar", triangle());
  harness.feed("odom", odometry_at({0.0, 0.0, 0.0}));
  harness.feed("goal", goal_at(20.0, 20.0, 1s));
  harness.advance(300ms);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_FAILED);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->reason, "no route: no edges lead from the start to the goal");
  harness.feed("goal", goal_at(8.0, 0.0, 2s));
  harness.advance(300ms);
  harness.take<GoalStatus>("goal_status");
  harness.feed("goal", goal_at(4.0, 3.0, 3s));
  harness.advance(300ms);
  std::vector<std::pair<std::string, GoalState>> seen;
  for (const auto& status : harness.take<GoalStatus>("goal_status")) seen.emplace_back(status->goal_id, status->state);
  const std::vector<std::pair<std::string, GoalState>> expected = {{"2.000000000", GoalState::GOAL_CANCELLED},
                                                                   {"3.000000000", GoalState::GOAL_PENDING},
                                                                   {"3.000000000", GoalState::GOAL_ACTIVE}};
  EXPECT_EQ(seen, expected);
}

}  // namespace
}  // namespace kervan::test
