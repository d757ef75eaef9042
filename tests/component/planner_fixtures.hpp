/// A room, and goals in it, for tests of planners on grids.
#pragma once

#include <chrono>
#include <vector>

#include "framework/test/harness.hpp"
#include "nav_msgs/msg/OccupancyGrid.hpp"
#include "nav_msgs/msg/Path.hpp"
#include "tests/component/map_fixtures.hpp"

namespace kervan::test {

inline constexpr int room_columns = 60, room_rows = 40;  // of 0.1 m

/// A room of 6 x 4 m without walls, with one across the middle that ends 1 m below its top.
inline std::vector<std::int8_t> room() {
  std::vector<std::int8_t> cells(room_columns * room_rows, 0);
  for (int y = 0; y < 30; ++y) cells[static_cast<std::size_t>(y * room_columns + 30)] = 100;
  return cells;
}

inline nav_msgs::msg::OccupancyGrid room_message() {
  nav_msgs::msg::OccupancyGrid map;
  map.header.frame_id = "map";
  map.info.resolution = 0.1f;
  map.info.width = room_columns;
  map.info.height = room_rows;
  map.info.origin = geometry::to_message(geometry::Pose2{});
  map.data = room();
  return map;
}

inline std::vector<geometry::Vector2> points_of(const nav_msgs::msg::Path& path) {
  std::vector<geometry::Vector2> points;
  for (const auto& pose : path.poses) points.push_back(geometry::position_of(pose.pose));
  return points;
}

/// The answer to one goal, which may have to wait for its turn after another.
inline const nav_msgs::msg::Path* ask(Harness& harness, double x, double y) {
  harness.feed("goal", pose_at(x, y));
  harness.advance(std::chrono::milliseconds(300));
  return harness.latest<nav_msgs::msg::Path>("route");
}

}  // namespace kervan::test
