#include <gtest/gtest.h>

#include <limits>

#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "kervan_msgs/msg/ReplanRequest.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/Path.hpp"
#include "std_msgs/msg/Header.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::TwistStamped;
using kervan_msgs::msg::ReplanRequest;
using std_msgs::msg::Header;

/// Four sonars, ahead, left, behind and right, on the edge of a robot of 0.2 m.
kervan_msgs::msg::SonarArray sonars(float ahead, float left, float behind, float right) {
  kervan_msgs::msg::SonarArray array;
  array.max_range = 5.0F;
  const float ranges[] = {ahead, left, behind, right};
  for (int i = 0; i < 4; ++i) {
    const double yaw = 1.5707963267948966 * i;
    kervan_msgs::msg::SonarReading reading;
    reading.x = static_cast<float>(0.2 * std::cos(yaw));
    reading.y = static_cast<float>(0.2 * std::sin(yaw));
    reading.yaw = static_cast<float>(yaw);
    reading.range = ranges[i];
    array.readings.push_back(reading);
  }
  return array;
}

ValueMap small_robot() { return {{"front", 0.2}, {"rear", 0.2}, {"half_width", 0.2}}; }

/// Stands before a wall for a time, told to drive on.
void stand(Harness& harness, Duration time) {
  for (Duration t{}; t < time; t += 50ms) {
    harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
    harness.feed("cmd_vel_wanted", twist_of(0.3, 0.1));
    harness.feed("sonar", sonars(0.05F, 3.0F, 3.0F, 3.0F));
    harness.advance(50ms);
  }
}

TEST(RecoveryComponent, PassesCommandsOnAsTheyAre) {
  Harness harness("control/recovery", small_robot());
  harness.feed("waypoint", pose_at(5.0, 1.0));
  stand(harness, 1s);
  const auto commands = harness.take<TwistStamped>("cmd_vel_raw");
  EXPECT_EQ(commands.size(), 20u);
  for (const auto& command : commands) EXPECT_EQ(command->twist, twist_of(0.3, 0.1).twist);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(RecoveryComponent, AsksOthersBacksUpAndGivesUp) {
  Harness harness("control/recovery", small_robot());
  harness.feed("waypoint", pose_at(5.0, 1.0));
  stand(harness, 5s);
  EXPECT_EQ(harness.take<Header>("forget").size(), 1u);
  stand(harness, 4s);
  ASSERT_EQ(harness.take<ReplanRequest>("replan").size(), 1u);
  harness.take<TwistStamped>("cmd_vel_raw");
  stand(harness, 5s);
  const auto commands = harness.take<TwistStamped>("cmd_vel_raw");
  ASSERT_FALSE(commands.empty());
  EXPECT_EQ(commands.back()->twist.linear.x, -0.15);
  EXPECT_EQ(harness.reason(), "trapped: backing up");
  stand(harness, 15s);
  const auto requests = harness.take<ReplanRequest>("replan");
  ASSERT_EQ(requests.size(), 1u);
  EXPECT_TRUE(requests[0]->give_up);
  EXPECT_EQ(requests[0]->reason,
            "trapped: the robot stands though it has somewhere to go, and nothing has helped: forgetting, a new plan, "
            "backing up");
  stand(harness, 30s);
  EXPECT_TRUE(harness.take<ReplanRequest>("replan").empty());
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel_raw")->twist, twist_of(0.3, 0.1).twist);
  kervan_msgs::msg::GoalStatus status;
  status.goal_id = "9.000000000";
  harness.feed("goal_status", status);
  stand(harness, 5s);
  EXPECT_EQ(harness.take<Header>("forget").size(), 1u) << "another goal";
}

TEST(RecoveryComponent, LooksAroundWhileThereIsNoWayToTheGoal) {
  Harness harness("control/recovery", small_robot());
  harness.feed("waypoint", pose_at(1.0, 1.0));
  harness.feed("route", nav_msgs::msg::Path{});
  stand(harness, 10s);
  EXPECT_EQ(harness.state(), ComponentState::active) << "there is no goal";
  kervan_msgs::msg::GoalStatus status;
  status.goal_id = "9.000000000";
  status.state = kervan_msgs::msg::GoalState::GOAL_ACTIVE;
  harness.feed("goal_status", status);
  harness.take<TwistStamped>("cmd_vel_raw");
  for (Duration t{}; t < 6s; t += 50ms) {
    harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
    harness.feed("cmd_vel_wanted", twist_of(0.0, 0.0));
    harness.feed("sonar", sonars(1.0F, 4.0F, 3.0F, 3.0F));
    harness.advance(50ms);
  }
  EXPECT_EQ(harness.reason(), "trapped: looking around");
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel_raw")->twist, twist_of(0.0, 0.6).twist);
  status.state = kervan_msgs::msg::GoalState::GOAL_FAILED;
  harness.feed("goal_status", status);
  stand(harness, 200ms);
  EXPECT_EQ(harness.state(), ComponentState::active) << "it was given up";
}

TEST(RecoveryComponent, EndsAManoeuvreWhenTheRobotDoesNotKnowWhereItIs) {
  Harness harness("control/recovery", small_robot());
  harness.feed("waypoint", pose_at(5.0, 1.0));
  stand(harness, 14s);
  ASSERT_EQ(harness.reason(), "trapped: backing up");
  harness.advance(1s);
  harness.take<TwistStamped>("cmd_vel_raw");
  harness.advance(1s);
  EXPECT_TRUE(harness.take<TwistStamped>("cmd_vel_raw").empty()) << "the guard brakes";
  EXPECT_EQ(harness.reason(), "cmd_vel_wanted: no sample for more than 0.25 s");
  harness.feed("cmd_vel_wanted", twist_of(0.3, 0.1));
  harness.feed("odom", odometry_at({std::numeric_limits<double>::quiet_NaN(), 1.0, 0.0}));
  harness.advance(100ms);
  EXPECT_EQ(harness.reason(), "odom: the pose is not finite");
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel_raw")->twist, twist_of(0.3, 0.1).twist);
}

}  // namespace
}  // namespace kervan::test
