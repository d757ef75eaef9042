#include <gtest/gtest.h>

#include "kervan_msgs/msg/GoalStatus.hpp"
#include "tests/component/planner_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using kervan_msgs::msg::GoalState;
using kervan_msgs::msg::GoalStatus;
using nav_msgs::msg::Path;

ValueMap small_robot() { return {{"radius", 0.2}, {"planner", std::string("RRTConnect")}, {"deadline", 0.05}}; }

std::string refusal_of(const ValueMap& parameters) {
  try {
    Harness harness("planning/ompl", parameters);
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "accepted";
}

std::vector<geometry::Vector2> route(const ValueMap& parameters) {
  Harness harness("planning/ompl", parameters);
  harness.feed("map", room_message());
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(10ms);
  return points_of(*ask(harness, 5.0, 1.0));
}

TEST(OmplComponent, PlansRoundAWall) {
  Harness harness("planning/ompl", small_robot());
  harness.feed("map", room_message());
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(10ms);
  const auto points = points_of(*ask(harness, 5.0, 1.0));
  ASSERT_GE(points.size(), 3u);
  EXPECT_EQ(points.front(), geometry::Vector2(1.0, 1.0));
  EXPECT_EQ(points.back(), geometry::Vector2(5.0, 1.0));
  double highest = 0.0;
  for (const auto& point : points) highest = std::max(highest, point.y());
  EXPECT_GT(highest, 3.1) << "round the end of the wall";
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_ACTIVE);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(OmplComponent, PlansTheSameAgainWithTheSameSeed) {
  ValueMap params = small_robot();
  params["planner"] = std::string("RRT");
  params["simplify"] = false;
  EXPECT_EQ(route(params), route(params));
  const auto first = route(params);
  params["seed"] = std::int64_t{2};
  EXPECT_NE(first, route(params));
}

TEST(OmplComponent, SaysThatThereWasNoWayInItsTimeAndGivesUpAtLast) {
  ValueMap params = small_robot();
  params["tries"] = std::int64_t{2};
  params["deadline"] = 0.002;
  Harness harness("planning/ompl", params);
  auto map = room_message();
  for (int y = 0; y < room_rows; ++y) map.data[static_cast<std::size_t>(y * room_columns + 30)] = 100;
  harness.feed("map", map);
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(10ms);
  EXPECT_TRUE(ask(harness, 5.0, 1.0)->poses.empty());
  EXPECT_EQ(harness.reason(), "no route: the planner found no way in its time");
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(2s);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_FAILED);
}

TEST(OmplComponent, RouteHasTheHeadingsOfARobotThatCannotTurnOnTheSpot) {
  ValueMap params = small_robot();
  params["space"] = std::string("reeds_shepp");
  params["goal_heading"] = std::string("given");
  Harness harness("planning/ompl", params);
  harness.feed("map", room_message());
  harness.feed("odom", odometry_at({1.0, 1.0, 2.0}));
  auto goal = pose_at(5.0, 1.0);
  goal.pose = geometry::to_message(geometry::Pose2{5.0, 1.0, -1.0});
  harness.feed("goal", goal);
  harness.advance(300ms);
  const Path* path = harness.latest<Path>("route");
  ASSERT_GE(path->poses.size(), 3u);
  EXPECT_NEAR(geometry::pose_of(path->poses.front().pose).yaw, 2.0, 1e-9);
  EXPECT_NEAR(geometry::pose_of(path->poses.back().pose).yaw, -1.0, 1e-9);
}

TEST(OmplComponent, RefusesAPlannerThatOmplDoesNotHave) {
  ValueMap params = small_robot();
  params["planner"] = std::string("RRTConect");
  EXPECT_EQ(refusal_of(params),
            "subject.planner: RRTConect is not one of PRMstar, PRM, LazyPRMstar, LazyPRM, RRTConnect, RRT, RRTstar, "
            "InformedRRTstar, SORRTstar, RRTsharp, RRTXstatic, BITstar, ABITstar, AITstar, EST, BiEST; did you mean "
            "'RRTConnect'?");
}

TEST(OmplComponent, RefusesPlannersThatDoNotKnowOneWayStreetsForDubins) {
  ValueMap params = small_robot();
  params["space"] = std::string("dubins");
  EXPECT_EQ(refusal_of(params),
            "subject.planner: RRTConnect takes a way back for as good as the way there, which it is not with space: "
            "dubins; allowed: RRT, RRTstar, InformedRRTstar, SORRTstar, EST");
  params["planner"] = std::string("RRTstar");
  EXPECT_EQ(refusal_of(params), "accepted");
}

TEST(OmplComponent, FailsUnderLockstepIfTheSameSeedIsNotTheSameRoute) {
  ValueMap params = small_robot();
  params["planner"] = std::string("LazyPRMstar");
  Harness harness("planning/ompl", params);
  EXPECT_EQ(harness.state(), ComponentState::failed);
  EXPECT_EQ(harness.reason(), "planner: LazyPRMstar may give another route for the same seed: not under lockstep (in on_activate)");
}

}  // namespace
}  // namespace kervan::test
