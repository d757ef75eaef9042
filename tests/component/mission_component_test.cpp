#include <gtest/gtest.h>

#include <cmath>

#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/Contact.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "kervan_msgs/msg/MissionResult.hpp"
#include "sensor_msgs/msg/Range.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::PoseStamped;
using kervan_msgs::msg::MissionOutcome;
using kervan_msgs::msg::MissionResult;

ValueMap to_ten(double timeout = 90.0) {
  return {{"goals", ValueMap{{"r1", ValueMap{{"at", points({{10.0, 0.0}})}}}}}, {"timeout", timeout}};
}

/// Truth of `robot` at 50 Hz from x0 to x1 in `time`.
void drive(Harness& harness, const std::string& robot, double x0, double x1, Duration time) {
  const double speed = (x1 - x0) / seconds(time);
  for (Duration t{}; t < time; t += 20ms) {
    harness.feed(robot + "/truth", odometry_at({x0 + speed * seconds(t), 0.0, 0.0}, {speed, 0.0}));
    harness.advance(20ms);
  }
}

TEST(MissionComponent, SendsTheGoalAtOnce) {
  Harness harness("observe/mission", to_ten());
  harness.advance(0ms);
  const auto* goal = harness.latest<PoseStamped>("r1/goal");
  ASSERT_TRUE(goal);
  EXPECT_EQ(goal->pose.position.x, 10.0);
  EXPECT_EQ(goal->header.frame_id, "map");
  harness.advance(20ms);
  EXPECT_EQ(harness.reason(), "r1/truth: nothing received yet");
}

TEST(MissionComponent, EndsTheRunWithSuccessWhenTheRobotStandsAtItsGoal) {
  Harness harness("observe/mission", to_ten());
  drive(harness, "r1", 0.0, 9.96, 20s);
  EXPECT_FALSE(harness.finished());
  drive(harness, "r1", 9.96, 9.96, 1s);
  EXPECT_TRUE(harness.finished());
  const auto* result = harness.latest<MissionResult>("result");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->result, MissionOutcome::MISSION_SUCCESS);
  EXPECT_EQ(result->reason, "");
  ASSERT_EQ(result->robots.size(), 1u);
  EXPECT_EQ(result->robots[0].robot, "r1");
  EXPECT_TRUE(result->robots[0].reached);
  EXPECT_NEAR(result->robots[0].error_m, 0.04, 1e-6);
  EXPECT_NEAR(result->robots[0].time_s, 20.0, 0.05);
  EXPECT_NEAR(result->robots[0].path_m, 9.96, 1e-6);
  EXPECT_TRUE(std::isnan(result->robots[0].min_clearance_m)) << "nobody told it";
}

TEST(MissionComponent, FailsAtTheTimeOutAndSaysHowFarTheRobotIs) {
  Harness harness("observe/mission", to_ten(5.0));
  drive(harness, "r1", 0.0, 9.71, 4s);
  kervan_msgs::msg::Contact contact;
  contact.robot = "r1";
  contact.count = 1;
  harness.feed("r1/contact", contact);
  for (const float distance : {0.5F, 0.25F, 0.75F}) {
    sensor_msgs::msg::Range clearance;
    clearance.range = distance;
    harness.feed("r1/clearance", clearance);
    harness.advance(20ms);
  }
  drive(harness, "r1", 9.71, 9.71, 2s);
  EXPECT_TRUE(harness.finished());
  const auto* result = harness.latest<MissionResult>("result");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->result, MissionOutcome::MISSION_FAILED);
  EXPECT_EQ(result->reason, "the time is up: r1 is 0.29 m from its goal");
  EXPECT_FALSE(result->robots[0].reached);
  EXPECT_EQ(result->robots[0].contacts, 1u);
  EXPECT_EQ(result->robots[0].min_clearance_m, 0.25);
  EXPECT_NEAR(result->robots[0].time_s, 5.0, 0.03);
}

TEST(MissionComponent, FailsAtTheTimeOutWithoutAnyTruth) {
  Harness harness("observe/mission", to_ten(5.0));
  harness.advance(5s);
  EXPECT_TRUE(harness.finished());
  EXPECT_EQ(harness.latest<MissionResult>("result")->result, MissionOutcome::MISSION_FAILED);
}

TEST(MissionComponent, SendsTheNextGoalWhenTheFirstIsReached) {
  Harness harness("observe/mission", {{"goals", ValueMap{{"r1", ValueMap{{"at", points({{1.0, 0.0}, {2.0, 0.0}})}}}}}});
  drive(harness, "r1", 1.0, 1.0, 1s);
  EXPECT_EQ(harness.latest<PoseStamped>("r1/goal")->pose.position.x, 2.0);
  EXPECT_FALSE(harness.finished());
  drive(harness, "r1", 2.0, 2.0, 1s);
  EXPECT_TRUE(harness.finished());
}

TEST(MissionComponent, WaitsForEveryRobot) {
  Harness harness("observe/mission", {{"goals", ValueMap{{"r1", ValueMap{{"at", points({{1.0, 0.0}})}}},
                                                         {"r2", ValueMap{{"at", points({{3.0, 0.0}})}}}}}});
  drive(harness, "r1", 1.0, 1.0, 1s);
  EXPECT_FALSE(harness.finished());
  EXPECT_EQ(harness.reason(), "r2/truth: nothing received yet");
  drive(harness, "r2", 3.0, 3.0, 1s);
  EXPECT_TRUE(harness.finished());
  const auto* result = harness.latest<MissionResult>("result");
  ASSERT_EQ(result->robots.size(), 2u);
  EXPECT_EQ(result->robots[1].robot, "r2");
}

TEST(MissionComponent, ReportsAbortedWhenTheRunIsEndedFromOutside) {
  Harness harness("observe/mission", to_ten());
  drive(harness, "r1", 0.0, 3.0, 5s);
  harness.end();
  const auto* result = harness.latest<MissionResult>("result");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->result, MissionOutcome::MISSION_ABORTED);
  EXPECT_NEAR(result->robots[0].path_m, 3.0, 0.02);
}

TEST(MissionComponent, FailsAtOnceWhenARobotGivesItsGoalUp) {
  Harness harness("observe/mission", to_ten());
  drive(harness, "r1", 0.0, 3.0, 5s);
  kervan_msgs::msg::GoalStatus status;
  status.state = kervan_msgs::msg::GoalState::GOAL_FAILED;
  status.goal_id = "77.000000000";
  status.reason = "no route: all is lost";
  harness.feed("r1/goal_status", status);
  harness.advance(20ms);
  EXPECT_FALSE(harness.finished()) << "that was another goal";
  status.goal_id = geometry::goal_id_of(harness.latest<PoseStamped>("r1/goal")->header.stamp);
  harness.feed("r1/goal_status", status);
  harness.advance(20ms);
  EXPECT_TRUE(harness.finished());
  const auto* result = harness.latest<MissionResult>("result");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->result, MissionOutcome::MISSION_FAILED);
  EXPECT_EQ(result->reason, "r1 has given up: no route: all is lost");
  EXPECT_FALSE(result->robots[0].reached);
  EXPECT_NEAR(result->robots[0].time_s, 5.04, 0.021);
}

TEST(MissionComponent, RefusesAMissionWithoutGoals) {
  EXPECT_THROW(Harness("observe/mission", {{"goals", ValueMap{}}}), ParameterError);
  EXPECT_THROW(Harness("observe/mission", {{"goals", ValueMap{{"r1", ValueMap{{"at", ValueList{}}}}}}}),
               ParameterError);
}

}  // namespace
}  // namespace kervan::test
