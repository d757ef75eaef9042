#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "framework/map_file/map_file.hpp"
#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "kervan_msgs/msg/ReplanRequest.hpp"
#include "tests/component/planner_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using kervan_msgs::msg::GoalState;
using kervan_msgs::msg::GoalStatus;
using nav_msgs::msg::OccupancyGrid;
using nav_msgs::msg::Path;
namespace fs = std::filesystem;

ValueMap small_robot() { return {{"radius", 0.2}, {"clearance", 0.2}}; }

std::string refusal_of(const ValueMap& parameters) {
  try {
    Harness harness("planning/astar_grid", parameters);
  } catch (const ParameterError& error) {
    return error.what();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(AstarGridComponent, PlansRoundAWall) {
  Harness harness("planning/astar_grid", small_robot());
  harness.feed("map", room_message());
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(10ms);
  const Path* route = ask(harness, 5.0, 1.0);
  ASSERT_TRUE(route);
  EXPECT_EQ(route->header.frame_id, "map");
  const auto points = points_of(*route);
  ASSERT_GE(points.size(), 3u);
  EXPECT_EQ(points.front(), geometry::Vector2(1.0, 1.0));
  EXPECT_EQ(points.back(), geometry::Vector2(5.0, 1.0));
  double highest = 0.0, length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    highest = std::max(highest, points[i].y());
    length += (points[i] - points[i - 1]).norm();
  }
  EXPECT_GT(highest, 3.1) << "round the end of the wall";
  EXPECT_LT(length, 6.5);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(AstarGridComponent, WaitsForOdometryAndMapAndThenPlansOnce) {
  Harness harness("planning/astar_grid", small_robot());
  harness.feed("goal", pose_at(5.0, 1.0));
  harness.advance(10ms);
  EXPECT_EQ(harness.state(), ComponentState::active) << "they may come any moment";
  harness.advance(100ms);
  EXPECT_EQ(harness.reason(), "odom: nothing received yet");
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(100ms);
  EXPECT_EQ(harness.reason(), "tiles: nothing received yet");
  EXPECT_FALSE(harness.latest<Path>("route"));
  for (int i = 0; i < 3; ++i) {
    harness.feed("map", room_message());
    harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
    harness.advance(50ms);
  }
  EXPECT_EQ(harness.take<Path>("route").size(), 1u);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(AstarGridComponent, PlansOnTilesAndThroughWhatNobodyHasSeen) {
  Harness harness("planning/astar_grid", small_robot());
  // A wall of 3 m on x = 1 m, cells of 5 cm.
  auto wall = map_tile({0, 0}, {});
  std::fill(wall.data.begin(), wall.data.end(), std::int8_t{0});
  for (std::size_t y = 0; y < 64; ++y) wall.data[y * 64 + 20] = 90;
  harness.feed("tiles", wall);
  harness.feed("odom", odometry_at({0.4, 1.5, 0.0}));
  harness.advance(10ms);
  const auto around = points_of(*ask(harness, 6.0, 1.5));
  ASSERT_GE(around.size(), 3u);
  EXPECT_EQ(around.back(), geometry::Vector2(6.0, 1.5));
  for (auto& cell : wall.data) cell = 0;
  harness.feed("tiles", wall);
  harness.advance(10ms);
  EXPECT_EQ(ask(harness, 6.0, 1.5)->poses.size(), 2u) << "the wall is gone";
}

TEST(AstarGridComponent, TakesTheUnknownForAnObstacleIfToldTo) {
  ValueMap params = small_robot();
  params["unknown"] = std::string("obstacle");
  Harness harness("planning/astar_grid", params);
  auto tile = map_tile({0, 0}, {});
  std::fill(tile.data.begin(), tile.data.end(), std::int8_t{0});
  harness.feed("tiles", tile);
  harness.feed("odom", odometry_at({0.4, 1.5, 0.0}));
  harness.advance(10ms);
  EXPECT_TRUE(ask(harness, 6.0, 1.5)->poses.empty());
  EXPECT_EQ(harness.reason(), "no route: the goal is outside of the map");
}

TEST(AstarGridComponent, BeginsWithTheMapOfAFile) {
  const fs::path folder = fs::temp_directory_path() / ("kervan_astar_grid_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const std::string file = (folder / "room.yaml").string();
  map_file::save({{}, 0.1, room_columns, room_rows, room()}, file, map_file::Mode::trinary);
  ValueMap params = small_robot();
  params["map"] = file;
  {
    Harness harness("planning/astar_grid", params);
    harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
    harness.advance(10ms);
    EXPECT_GE(ask(harness, 5.0, 1.0)->poses.size(), 3u);
    EXPECT_TRUE(ask(harness, 6.1, 1.0)->poses.empty()) << "whole maps end where they end";
    EXPECT_EQ(harness.reason(), "no route: the goal is outside of the map");
  }
  params["memory"] = 0.1;
  map_file::save({{}, 0.1, 100, 100, std::vector<std::int8_t>(10'000, 0)}, file, map_file::Mode::trinary);
  EXPECT_EQ(refusal_of(params), "subject.map: the map of 100 x 100 cells needs a memory of 2 MiB");
  std::ofstream(file) << "image: room.png\nresolution: 0\norigin: [0, 0, 0]\n";
  EXPECT_NE(refusal_of(params).find("room.yaml:2:13: "), std::string::npos) << refusal_of(params);
  fs::remove_all(folder);
}

TEST(AstarGridComponent, SaysWhyThereIsNoRouteAndPublishesAnEmptyOne) {
  ValueMap params = small_robot();
  params["tolerance"] = 0.0;
  Harness harness("planning/astar_grid", params);
  OccupancyGrid map = room_message();
  for (int y = 30; y < room_rows; ++y) map.data[static_cast<std::size_t>(y * room_columns + 30)] = 100;
  harness.feed("map", map);
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(10ms);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<geometry::Vector2, std::string>> goals = {
      {{5.0, 1.0}, "no route: no free way leads from the robot to the goal"},
      {{3.05, 1.0}, "no route: the goal is too near to an obstacle, and so is all within its tolerance"},
      {{-1.0, 1.0}, "no route: the goal is outside of the map"},
      {{nan, 1.0}, "no route: the goal has a coordinate that is no number"}};
  for (const auto& [goal, why] : goals) {
    const Path* route = ask(harness, goal.x(), goal.y());
    ASSERT_TRUE(route);
    EXPECT_TRUE(route->poses.empty());
    EXPECT_EQ(harness.state(), ComponentState::degraded);
    EXPECT_EQ(harness.reason(), why);
  }
  EXPECT_EQ(ask(harness, 2.0, 2.0)->poses.size(), 2u);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(AstarGridComponent, ToleranceAndLimitMayChangeWhileItRuns) {
  Harness harness("planning/astar_grid", small_robot());
  harness.feed("map", room_message());
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(10ms);
  EXPECT_GE(ask(harness, 2.95, 1.0)->poses.size(), 2u) << "it ends beside the wall";
  harness.change_parameters({{"tolerance", 0.1}});
  EXPECT_TRUE(ask(harness, 2.95, 1.0)->poses.empty());
  harness.change_parameters({{"most_expanded", std::int64_t{3}}});
  EXPECT_TRUE(ask(harness, 5.0, 1.0)->poses.empty());
  EXPECT_EQ(harness.reason(), "no route: the search was given up, it looked at as many cells as it may");
}

TEST(AstarGridComponent, EscapesFromTooNearAnObstacle) {
  Harness harness("planning/astar_grid", small_robot());
  harness.feed("map", room_message());
  harness.feed("odom", odometry_at({2.9, 1.0, 0.0}));
  harness.advance(10ms);
  const auto points = points_of(*ask(harness, 1.0, 1.0));
  ASSERT_GE(points.size(), 3u);
  EXPECT_EQ(points[0], geometry::Vector2(2.9, 1.0));
  EXPECT_NEAR(points[1].x(), 2.75, 1e-6);
  harness.change_parameters({{"escape", 0.0}});
  EXPECT_TRUE(ask(harness, 1.0, 1.0)->poses.empty());
  EXPECT_EQ(harness.reason(), "no route: the robot is too near to an obstacle, and no free place is within its reach");
}

TEST(AstarGridComponent, LeavesOutMapsAndTilesThatDoNotFit) {
  Harness harness("planning/astar_grid", small_robot());
  harness.feed("map", room_message());
  harness.advance(10ms);
  const auto expect_refused = [&](const std::string& why) {
    harness.advance(100ms);
    EXPECT_EQ(harness.state(), ComponentState::degraded);
    EXPECT_EQ(harness.reason(), why);
  };
  OccupancyGrid map = room_message();
  map.data.pop_back();
  harness.feed("map", map);
  expect_refused("map: its size or the number of its cells is none");
  map = room_message();
  map.data[7] = 101;
  harness.feed("map", map);
  expect_refused("map: a percentage is none");
  map = room_message();
  map.info.origin = geometry::to_message(geometry::Pose2{0.0, 0.0, 0.5});
  harness.feed("map", map);
  expect_refused("map: the map is turned by 0.500000 rad against its frame; allowed: 0");
  harness.feed("tiles", map_tile({0, 0}, {}));
  expect_refused("tiles: cells of another size are left out");
  auto tile = map_tile({0, 0}, {120});
  tile.resolution = 0.1f;
  harness.feed("tiles", tile);
  expect_refused("tiles: a percentage is none, its tile is left out");
  tile = map_tile({5000, 0}, {});
  tile.resolution = 0.1f;
  harness.feed("tiles", tile);
  expect_refused("tiles: memory is used up, tiles beyond the map are left out");
  // The map that was there is still planned on.
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  EXPECT_GE(ask(harness, 5.0, 1.0)->poses.size(), 3u);
}

TEST(AstarGridComponent, RefusesJumpPointsWhereCellsDiffer) {
  ValueMap params = small_robot();
  params["search"] = std::string("jump_point");
  EXPECT_EQ(refusal_of(params),
            "subject.search: jump_point needs cells that all cost the same; allowed with clearance_cost: 0");
  params["clearance_cost"] = 0.0;
  EXPECT_EQ(refusal_of(params), "accepted");
}

/// Drives straight from x0 to x1 along y, with odometry at 20 Hz.
void drive(Harness& harness, double x0, double x1, double y, Duration time) {
  for (Duration t{}; t <= time; t += 50ms) {
    harness.feed("odom", odometry_at({x0 + (x1 - x0) * seconds(t) / seconds(time), y, 0.0}));
    harness.advance(50ms);
  }
}

OccupancyGrid with_wall_closed() {
  OccupancyGrid map = room_message();
  for (int y = 30; y < room_rows; ++y) map.data[static_cast<std::size_t>(y * room_columns + 30)] = 100;
  return map;
}

OccupancyGrid without_wall() {
  OccupancyGrid map = room_message();
  map.data.assign(map.data.size(), 0);
  return map;
}

TEST(AstarGridComponent, PlansAgainFromWhereTheRobotIsWhenAnObstacleAppearsOnTheRoute) {
  Harness harness("planning/astar_grid", small_robot());
  harness.feed("map", without_wall());
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(10ms);
  EXPECT_EQ(ask(harness, 5.0, 1.0)->poses.size(), 2u);
  drive(harness, 1.0, 2.0, 1.0, 2s);
  EXPECT_EQ(harness.take<Path>("route").size(), 1u) << "nothing called for another";
  harness.feed("map", room_message());
  drive(harness, 2.0, 2.0, 1.0, 100ms);
  const auto points = points_of(*harness.latest<Path>("route"));
  ASSERT_GE(points.size(), 3u);
  EXPECT_EQ(points.front(), geometry::Vector2(2.0, 1.0));
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_ACTIVE);
  harness.take<Path>("route");
  drive(harness, 2.0, 2.1, 1.5, 2s);
  EXPECT_EQ(harness.take<Path>("route").size(), 0u);
}

TEST(AstarGridComponent, StopsTheRobotWhenThereIsNoWayAnyMoreTriesAgainAndGivesUp) {
  ValueMap params = small_robot();
  params["tries"] = std::int64_t{3};
  Harness harness("planning/astar_grid", params);
  harness.feed("map", room_message());
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(10ms);
  EXPECT_GE(ask(harness, 5.0, 1.0)->poses.size(), 3u);
  harness.feed("map", with_wall_closed());
  drive(harness, 1.0, 1.0, 1.0, 500ms);
  EXPECT_TRUE(harness.latest<Path>("route")->poses.empty());
  EXPECT_EQ(harness.state(), ComponentState::degraded);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_ACTIVE) << "it may open again";
  harness.feed("map", room_message());
  drive(harness, 1.0, 1.0, 1.0, 1s);
  EXPECT_GE(harness.latest<Path>("route")->poses.size(), 3u);
  EXPECT_EQ(harness.state(), ComponentState::active);
  harness.feed("map", with_wall_closed());
  drive(harness, 1.0, 1.0, 1.0, 4s);
  EXPECT_TRUE(harness.latest<Path>("route")->poses.empty());
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_FAILED);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->reason,
            "no route: no free way leads from the robot to the goal");
}

TEST(AstarGridComponent, DrivesAListOfGoalsOneAfterTheOther) {
  Harness harness("planning/astar_grid", small_robot());
  harness.feed("map", room_message());
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  Path goals;
  goals.header = pose_at(0, 0).header;
  goals.header.stamp.sec = 7;
  goals.poses = {pose_at(2.0, 1.0), pose_at(2.0, 3.0)};
  harness.feed("goals", goals);
  drive(harness, 1.0, 1.0, 1.0, 100ms);
  EXPECT_EQ(points_of(*harness.latest<Path>("route")).back(), geometry::Vector2(2.0, 1.0));
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->goal_id, "7.000000000/1");
  drive(harness, 1.0, 2.0, 1.0, 1s);
  drive(harness, 2.0, 2.0, 1.0, 300ms);
  EXPECT_EQ(points_of(*harness.latest<Path>("route")).back(), geometry::Vector2(2.0, 3.0));
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->goal_id, "7.000000000/2");
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_ACTIVE);
  drive(harness, 2.0, 2.0, 3.0, 100ms);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_REACHED);
  goals.poses = {pose_at(1.0, 1.0)};
  harness.feed("goals", goals);
  harness.advance(100ms);
  goals.poses.clear();
  harness.feed("goals", goals);
  harness.advance(100ms);
  EXPECT_TRUE(harness.latest<Path>("route")->poses.empty());
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_CANCELLED);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->reason, "withdrawn");
}

TEST(AstarGridComponent, PlansAgainOrGivesUpWhenAskedTo) {
  Harness harness("planning/astar_grid", small_robot());
  harness.feed("map", room_message());
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(10ms);
  ask(harness, 5.0, 1.0);
  harness.advance(1s);
  harness.take<Path>("route");
  kervan_msgs::msg::ReplanRequest request;
  request.reason = "the robot has turned";
  harness.feed("replan", request);
  harness.advance(10ms);
  EXPECT_EQ(harness.take<Path>("route").size(), 1u);
  request.give_up = true;
  request.reason = "nothing helps";
  harness.feed("replan", request);
  harness.advance(10ms);
  EXPECT_TRUE(harness.latest<Path>("route")->poses.empty());
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_FAILED);
  EXPECT_EQ(harness.reason(), "nothing helps");
}

TEST(AstarGridComponent, PlansForATargetThatJumpsAtABoundedRate) {
  Harness harness("planning/astar_grid", small_robot());
  harness.feed("map", without_wall());
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(10ms);
  for (int i = 0; i < 100; ++i) {
    harness.feed("goal", pose_at(3.0 + 0.02 * i, 1.0 + 0.02 * (i % 7)));
    harness.advance(10ms);
  }
  EXPECT_EQ(harness.take<Path>("route").size(), 5u) << "one each 200 ms";
  harness.advance(300ms);
  EXPECT_NEAR(points_of(*harness.latest<Path>("route")).back().x(), 4.98, 1e-9) << "the last one";
}

TEST(AstarGridComponent, ReachesAGoalThatCannotBeReachedAsNearAsItCan) {
  Harness harness("planning/astar_grid", small_robot());
  harness.feed("map", room_message());
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.change_parameters({{"reached_within", 0.05}});
  harness.advance(10ms);
  const auto points = points_of(*ask(harness, 2.95, 1.0));
  drive(harness, 1.0, points.back().x(), points.back().y(), 2s);
  const auto* status = harness.latest<GoalStatus>("goal_status");
  EXPECT_EQ(status->state, GoalState::GOAL_REACHED);
  EXPECT_EQ(status->reason, "as near as there is a free place");
  EXPECT_GT(status->distance, 0.1);
}

TEST(AstarGridComponent, GivesAGoalThatIsNoNumberUpAtOnce) {
  Harness harness("planning/astar_grid", small_robot());
  harness.feed("map", room_message());
  harness.feed("odom", odometry_at({1.0, 1.0, 0.0}));
  harness.advance(10ms);
  ask(harness, std::numeric_limits<double>::infinity(), 1.0);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->state, GoalState::GOAL_FAILED);
  EXPECT_EQ(harness.latest<GoalStatus>("goal_status")->reason, "no route: the goal has a coordinate that is no number");
}

}  // namespace
}  // namespace kervan::test
