#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "kervan_msgs/msg/Outline.hpp"
#include "nav_msgs/msg/Path.hpp"
#include "tests/component/plane_fixtures.hpp"
#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::PoseStamped;
using geometry_msgs::msg::TwistStamped;
using kervan_msgs::msg::GoalState;

const ValueMap in_ten_by_ten = {{"area", points({{0, 0}, {10, 10}})}};

/// Half a second in which the robot is at `pose` and its controller says `twist`.
void be_at(Harness& harness, const geometry::Pose2& pose, double linear = 0.5) {
  for (int i = 0; i < 10; ++i) {
    harness.feed("truth", odometry_at(pose));
    harness.feed("cmd_vel_wanted", twist_of(linear, 0.0));
    harness.advance(50ms);
  }
}

nav_msgs::msg::Path straight(const geometry::Vector2& from, const PoseStamped& to) {
  nav_msgs::msg::Path path;
  path.poses = {pose_at(from.x(), from.y()), to};
  return path;
}

void tell(Harness& harness, const PoseStamped& goal, GoalState state) {
  kervan_msgs::msg::GoalStatus status;
  status.goal_id = geometry::goal_id_of(goal.header.stamp);
  status.state = state;
  harness.feed("goal_status", status);
  harness.advance(100ms);
}

TEST(RandomTargetsComponent, SendsATargetAndTheNextWhenTheRobotIsThere) {
  Harness harness("exploration/random_targets", in_ten_by_ten);
  be_at(harness, {5, 5, 0});
  ASSERT_TRUE(harness.latest<PoseStamped>("goal"));
  const PoseStamped first = *harness.latest<PoseStamped>("goal");
  EXPECT_EQ(first.header.frame_id, "odom") << "the frame of the truth";
  be_at(harness, {first.pose.position.x + 0.3, first.pose.position.y, 0});
  EXPECT_NE(harness.latest<PoseStamped>("goal")->pose, first.pose);
  EXPECT_EQ(harness.take<PoseStamped>("goal").size(), 2u);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(RandomTargetsComponent, PassesCommandsOnUntilTheRobotIsStuckAndThenGetsItFree) {
  Harness harness("exploration/random_targets", in_ten_by_ten);
  be_at(harness, {5, 5, 0});
  const PoseStamped first = *harness.latest<PoseStamped>("goal");
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel_raw")->twist.linear.x, 0.5);
  for (int i = 0; i < 9; ++i) be_at(harness, {5, 5, 0});
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel_raw")->twist.linear.x, -0.3);
  be_at(harness, {4.4, 5, 0});
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel_raw")->twist.linear.x, 0.0);
  EXPECT_EQ(std::abs(harness.latest<TwistStamped>("cmd_vel_raw")->twist.angular.z), 0.75);
  for (int i = 0; i < 30; ++i) be_at(harness, {4.4, 5, 0}, 0.0);  // it cannot turn
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel_raw")->twist, geometry_msgs::msg::Twist()) << "the controller's";
  EXPECT_NE(harness.latest<PoseStamped>("goal")->pose, first.pose);
}

TEST(RandomTargetsComponent, ATargetThatThePlannerGivesUpIsReplaced) {
  Harness harness("exploration/random_targets", in_ten_by_ten);
  be_at(harness, {5, 5, 0});
  const PoseStamped first = *harness.latest<PoseStamped>("goal");
  tell(harness, first, GoalState::GOAL_ACTIVE);
  EXPECT_EQ(harness.latest<PoseStamped>("goal")->pose, first.pose);
  tell(harness, first, GoalState::GOAL_FAILED);
  const PoseStamped second = *harness.latest<PoseStamped>("goal");
  EXPECT_NE(second.pose, first.pose);
  tell(harness, first, GoalState::GOAL_FAILED);
  EXPECT_EQ(harness.latest<PoseStamped>("goal")->pose, second.pose) << "the word is about another one";
}

TEST(RandomTargetsComponent, WritesWhatItCountedForTheSummary) {
  const Folder folder;
  Harness harness("exploration/random_targets", in_ten_by_ten, folder.path());
  be_at(harness, {5, 5, 0});
  const PoseStamped target = *harness.latest<PoseStamped>("goal");
  harness.feed("route", straight({5, 5}, target));
  harness.advance(10ms);
  const geometry::Vector2 way(target.pose.position.x - 5, target.pose.position.y - 5);
  for (double driven = 0.2; driven < way.norm(); driven += 0.2) {
    const geometry::Vector2 place = geometry::Vector2(5, 5) + driven / way.norm() * way;
    be_at(harness, {place.x(), place.y(), 0});
  }
  harness.end();
  const std::string figures = text_of(folder.path() / "figures-subject.json");
  const int metres = static_cast<int>(way.norm());
  EXPECT_NE(figures.find("\"points\": " + std::to_string(metres) + ","), std::string::npos) << figures << way.norm();
  EXPECT_NE(figures.find("\"reached\": 1, \"stuck\": 0, \"targets\": 2"), std::string::npos) << figures;
  EXPECT_NE(figures.find("\"contacts\": 0, \"first_reached_s\": "), std::string::npos) << figures;
}

TEST(RandomTargetsComponent, SaysWhatItLacks) {
  Harness blind("exploration/random_targets", in_ten_by_ten);
  blind.advance(1s);
  EXPECT_EQ(blind.state(), ComponentState::degraded);
  EXPECT_EQ(blind.reason(), "truth: nothing received yet");
  be_at(blind, {std::numeric_limits<double>::quiet_NaN(), 0, 0});
  EXPECT_EQ(blind.reason(), "truth: the pose is not finite");
  EXPECT_EQ(blind.latest<TwistStamped>("cmd_vel_raw")->twist.linear.x, 0.5) << "the controller drives on";
  EXPECT_FALSE(blind.latest<PoseStamped>("goal"));

  Harness nowhere("exploration/random_targets", {{"room", 0.4}});
  be_at(nowhere, {5, 5, 0});
  EXPECT_EQ(nowhere.reason(), "world: nothing received yet");
  kervan_msgs::msg::Outline closet;
  closet.segments = {{0, 0, 1, 0}, {1, 0, 1, 1}, {1, 1, 0, 1}, {0, 1, 0, 0}};
  nowhere.feed("world", closet);
  be_at(nowhere, {0.5, 0.5, 0});
  EXPECT_TRUE(nowhere.latest<PoseStamped>("goal"));
}

TEST(RandomTargetsComponent, SaysThatNothingHasRoomForATarget) {
  Harness harness("exploration/random_targets", {{"room", 0.6}});
  kervan_msgs::msg::Outline closet;
  closet.segments = {{0, 0, 1, 0}, {1, 0, 1, 1}, {1, 1, 0, 1}, {0, 1, 0, 0}};
  harness.feed("world", closet);
  be_at(harness, {0.5, 0.5, 0});
  EXPECT_EQ(harness.reason(), "no place with enough room for a target");
}

TEST(RandomTargetsComponent, RefusesAnAreaThatIsNone) {
  for (const Value& area : {points({{0, 0}}), points({{0, 0}, {0, 5}}), points({{0, 0}, {1, 1}, {2, 2}})}) try {
      Harness harness("exploration/random_targets", {{"area", area}});
      ADD_FAILURE();
    } catch (const ParameterError& error) {
      EXPECT_STREQ(error.what(),
                   "subject.area: it needs two opposite corners of a rectangle, such as [[0 m, 0 m], [20 m, 15 m]]");
    }
}

}  // namespace
}  // namespace kervan::test
