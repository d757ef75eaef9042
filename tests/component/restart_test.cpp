// Components that are constructed while a run is under way, as after the restart of their container.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/MissionResult.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/Path.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::PoseStamped;
using geometry_msgs::msg::TwistStamped;
using kervan_msgs::msg::MissionOutcome;
using kervan_msgs::msg::MissionResult;
using nav_msgs::msg::Path;
namespace fs = std::filesystem;

/// A run's folder that is gone when the test ends.
class RunFolder {
 public:
  RunFolder() { fs::create_directories(path_); }
  ~RunFolder() { fs::remove_all(path_); }
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  const fs::path& path() const { return path_; }
  void write(const std::string& text) const { std::ofstream(path_ / "mission.state") << text; }
  std::string state() const {
    std::ifstream file(path_ / "mission.state");
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  fs::path path_ = fs::temp_directory_path() / ("kervan_restart_test_" + std::to_string(getpid()));
};

ValueMap two_goals() {
  return {{"goals", ValueMap{{"r1", ValueMap{{"at", points({{5.0, 0.0}, {10.0, 0.0}})}}}}}, {"timeout", 90.0}};
}

void stand(Harness& harness, double x, Duration time) {
  for (Duration t{}; t < time; t += 20ms) {
    harness.feed("r1/truth", odometry_at({x, 0.0, 0.0}));
    harness.advance(20ms);
  }
}

TEST(Restart, TheMissionGoesOnWithTheGoalItWasAtAndTheFiguresSoFar) {
  const RunFolder folder;
  std::string state;
  {
    Harness harness("observe/mission", two_goals(), folder.path());
    stand(harness, 5.0, 1s);
    ASSERT_EQ(harness.latest<PoseStamped>("r1/goal")->pose.position.x, 10.0);
    stand(harness, 7.0, 2s);
    state = folder.state();
  }
  EXPECT_EQ(folder.state(), "") << "after a run that ended in good order there is nothing to go on with";
  folder.write(state);  // as a killed process leaves it
  Harness harness("observe/mission", two_goals(), folder.path());
  harness.advance(0ms);
  EXPECT_EQ(harness.latest<PoseStamped>("r1/goal")->pose.position.x, 10.0);
  stand(harness, 10.0, 1s);
  ASSERT_TRUE(harness.finished());
  const auto* result = harness.latest<MissionResult>("result");
  EXPECT_EQ(result->result, MissionOutcome::MISSION_SUCCESS);
  EXPECT_EQ(result->robots[0].path_m, 2.0) << "from 5 to 7, before";
}

TEST(Restart, TheMissionsTimeOutCountsFromItsFirstStart) {
  const RunFolder folder;
  folder.write("kervan_mission 1\nr1 -85000000000 1 7.5 2 0.25\n");  // began 85 s ago
  Harness harness("observe/mission", two_goals(), folder.path());
  stand(harness, 7.5, 4900ms);
  EXPECT_FALSE(harness.finished());
  stand(harness, 7.5, 200ms);
  ASSERT_TRUE(harness.finished());
  const auto* result = harness.latest<MissionResult>("result");
  EXPECT_EQ(result->result, MissionOutcome::MISSION_FAILED);
  EXPECT_EQ(result->robots[0].contacts, 2u);
  EXPECT_EQ(result->robots[0].min_clearance_m, 0.25);
  EXPECT_EQ(result->robots[0].time_s, 90.0);
}

TEST(Restart, AMissionThatCannotReadWhatItKeptBeginsAnew) {
  const RunFolder folder;
  folder.write("kervan_mission 1\nr1 -8500");
  Harness harness("observe/mission", two_goals(), folder.path());
  harness.advance(0ms);
  EXPECT_EQ(harness.latest<PoseStamped>("r1/goal")->pose.position.x, 5.0);
}

TEST(Restart, ThePlannerPlansFromWhereTheRobotIsOnItsWay) {
  Harness harness("planning/waypoint_astar",
                  {{"nodes", points({{0, 0}, {6, 0}, {12, 0}})}, {"edges", pairs({{0, 1}, {1, 2}})}});
  harness.feed("goal", pose_at(12.0, 0.0));
  harness.feed("odom", odometry_at({3.5, 0.4, 0.0}));
  harness.advance(10ms);
  const auto* route = harness.latest<Path>("route");
  ASSERT_TRUE(route);
  ASSERT_EQ(route->poses.size(), 2u);
  EXPECT_EQ(route->poses[0].pose.position.x, 6.0) << "on, not back to the first waypoint";
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(Restart, TheFollowerGoesOnFromWhereTheRobotIs) {
  Harness harness("control/route_follower");
  Path route;
  route.header.frame_id = "map";
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {6.0, 0.0}, {6.0, 6.0}, {12.0, 6.0}})
    route.poses.push_back(pose_at(x, y));
  harness.feed("route", route);
  harness.advance(10ms);
  EXPECT_FALSE(harness.latest<PoseStamped>("waypoint")) << "where to is not known before where from";
  harness.feed("odom", odometry_at({6.3, 2.0, 0.0}));
  harness.advance(10ms);
  const auto* waypoint = harness.latest<PoseStamped>("waypoint");
  ASSERT_TRUE(waypoint);
  EXPECT_EQ(waypoint->pose.position.x, 6.0);
  EXPECT_EQ(waypoint->pose.position.y, 6.0);
}

TEST(Restart, TheControllerStandsUntilItKnowsEverythingAndThenDrivesOn) {
  Harness harness("control/potential_field");
  harness.feed("waypoint", pose_at(5.0, 0.0));
  harness.advance(200ms);
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel_raw")->twist.linear.x, 0.0);
  kervan_msgs::msg::SonarArray sonar;
  sonar.max_range = 5.0F;
  harness.feed("odom", odometry_at({1.0, 0.0, 0.0}, {0.5, 0.0}));
  harness.feed("sonar", sonar);
  harness.advance(100ms);
  EXPECT_GT(harness.latest<TwistStamped>("cmd_vel_raw")->twist.linear.x, 0.0);
}

TEST(Restart, TheGuardBeginsWithZeroAndFollowsTheNextFreshCommand) {
  Harness harness("safety/drive_guard");
  harness.advance(0ms);
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel")->twist.linear.x, 0.0);
  harness.feed("cmd_vel_raw", twist_of(0.5, 0.0));
  harness.advance(100ms);
  EXPECT_GT(harness.latest<TwistStamped>("cmd_vel")->twist.linear.x, 0.0);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

}  // namespace
}  // namespace kervan::test
