#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "components/grid/cells.hpp"
#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/FrontierClaim.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "kervan_msgs/msg/MapTile.hpp"
#include "tests/component/plane_fixtures.hpp"
#include "tests/program/program.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry::Vector2;
using geometry_msgs::msg::PoseStamped;
using kervan_msgs::msg::ExplorationState;
using kervan_msgs::msg::FrontierClaim;
using kervan_msgs::msg::GoalState;
using kervan_msgs::msg::MapTile;

/// A room of 5.4 m by 5.4 m with doors of 1.2 m to the right and at the top; `right`, `top`: they are still unknown
/// beyond, else shut.
void see_room(Harness& harness, bool right = true, bool top = true) {
  const auto in = [](const Vector2& p, double x0, double y0, double x1, double y1) {
    return p.x() > x0 && p.y() > y0 && p.x() < x1 && p.y() < y1;
  };
  for (int ty = 0; ty < 3; ++ty)
    for (int tx = 0; tx < 3; ++tx) {
      MapTile tile;
      tile.tile_x = tx;
      tile.tile_y = ty;
      tile.resolution = 0.05f;
      tile.width = tile.height = grid::tile_side;
      const grid::CellBox box = grid::cells_of_tile({tx, ty});
      for (int y = box.y; y < box.y + box.rows; ++y)
        for (int x = box.x; x < box.x + box.columns; ++x) {
          const Vector2 p = grid::center_of({x, y}, 0.05);
          const bool free =
              in(p, 0.5, 0.5, 5.9, 5.9) || (right && in(p, 5.8, 2.4, 6.2, 3.6)) || (top && in(p, 2.4, 5.8, 3.6, 6.2));
          tile.data.push_back(free ? std::int8_t{0} : in(p, 0.3, 0.3, 6.1, 6.1) ? std::int8_t{100} : std::int8_t{-1});
        }
      harness.feed("tiles", tile);
    }
}

void be_at(Harness& harness, double x, double y, Duration time = 600ms) {
  harness.feed("odom", odometry_at({x, y, 0}));
  harness.advance(time);
}

FrontierClaim claim_of(const char* robot, double x, double y, Time stamp) {
  FrontierClaim claim;
  claim.robot = robot;
  claim.header.stamp = geometry::to_message(stamp);
  claim.state = ExplorationState::EXPLORATION_DRIVING;
  claim.x = x;
  claim.y = y;
  return claim;
}

void fail(Harness& harness) {
  kervan_msgs::msg::GoalStatus status;
  status.goal_id = geometry::goal_id_of(harness.latest<PoseStamped>("goal")->header.stamp);
  status.state = GoalState::GOAL_FAILED;
  harness.feed("goal_status", status);
}

Vector2 goal(const Harness& harness) { return geometry::position_of(harness.latest<PoseStamped>("goal")->pose); }

TEST(FrontierComponent, DrivesToTheNearestDoorAndSaysSo) {
  Harness harness("exploration/frontier");
  see_room(harness);
  be_at(harness, 5, 3);
  ASSERT_TRUE(harness.latest<PoseStamped>("goal"));
  EXPECT_LT((goal(harness) - Vector2(6.1, 3.0)).norm(), 0.2);
  const auto* claim = harness.latest<FrontierClaim>("claim");
  EXPECT_EQ(claim->state, ExplorationState::EXPLORATION_DRIVING);
  EXPECT_EQ(Vector2(claim->x, claim->y), goal(harness));
  EXPECT_EQ(harness.state(), ComponentState::active);
  be_at(harness, 3, 5, 10s);
  EXPECT_EQ(harness.take<PoseStamped>("goal").size(), 1u) << "it stays with what it has chosen";
}

TEST(FrontierComponent, GoesOnWhenItsFrontierHasBeenSeenAndIsDoneWhenThereIsNone) {
  Harness harness("exploration/frontier");
  see_room(harness);
  be_at(harness, 5, 3);
  see_room(harness, false, true);
  be_at(harness, 5, 3);
  EXPECT_LT((goal(harness) - Vector2(3.0, 6.1)).norm(), 0.2);
  see_room(harness, false, false);
  be_at(harness, 5, 3);
  EXPECT_EQ(harness.latest<FrontierClaim>("claim")->state, ExplorationState::EXPLORATION_DONE);
  EXPECT_FALSE(harness.finished());
}

TEST(FrontierComponent, PutsAsideWhatCannotBeReached) {
  Harness harness("exploration/frontier");
  see_room(harness);
  be_at(harness, 5, 3);
  fail(harness);
  be_at(harness, 5, 3);
  EXPECT_LT((goal(harness) - Vector2(3.0, 6.1)).norm(), 0.2);
  fail(harness);
  be_at(harness, 5, 3);
  EXPECT_EQ(harness.latest<FrontierClaim>("claim")->state, ExplorationState::EXPLORATION_WAITING);
  for (int i = 0; i < 70; ++i) be_at(harness, 5, 3, 500ms);
  EXPECT_EQ(harness.latest<FrontierClaim>("claim")->state, ExplorationState::EXPLORATION_DRIVING) << "it tries again";
}

TEST(FrontierComponent, TakesNoFrontierThatAnotherRobotHasChosen) {
  Harness harness("exploration/frontier");
  see_room(harness);
  harness.feed("claims", claim_of("r2/explorer", 6.1, 3.0, harness.now()));
  be_at(harness, 5, 3);
  EXPECT_LT((goal(harness) - Vector2(3.0, 6.1)).norm(), 0.2);
}

TEST(FrontierComponent, OfTwoThatChooseTheSameTheEarlierKeepsIt) {
  Harness harness("exploration/frontier");
  see_room(harness);
  be_at(harness, 5, 3, 2s);
  harness.feed("claims", claim_of("a", 6.1, 3.0, harness.now()));
  be_at(harness, 5, 3);
  EXPECT_LT((goal(harness) - Vector2(6.1, 3.0)).norm(), 0.2) << "this robot was first";
  harness.feed("claims", claim_of("b", 6.1, 3.0, Time{}));
  be_at(harness, 5, 3, 10ms);
  EXPECT_LT((goal(harness) - Vector2(3.0, 6.1)).norm(), 0.2) << "the other was";
}

TEST(FrontierComponent, IsDoneWhenEnoughIsKnown) {
  Harness harness("exploration/frontier", {{"enough", 29.0}});
  see_room(harness);
  be_at(harness, 5, 3);
  EXPECT_EQ(harness.latest<FrontierClaim>("claim")->state, ExplorationState::EXPLORATION_DONE);
  EXPECT_FALSE(harness.latest<PoseStamped>("goal"));
}

/// One of two robots on an open floor of 19.2 m by 19.2 m, of which each sees the tiles around it and tells both.
struct Explorer {
  Harness harness{"exploration/frontier"};
  const char* name;  ///< as the other one knows it
  Vector2 at{9.0, 9.0};

  /// What it has chosen, if it drives there.
  std::optional<Vector2> choice() const {
    const auto* claim = harness.latest<FrontierClaim>("claim");
    if (!claim || claim->state != ExplorationState::EXPLORATION_DRIVING) return std::nullopt;
    return Vector2(claim->x, claim->y);
  }
};

MapTile floor_tile(int tx, int ty) {
  constexpr int tiles = 6;
  MapTile tile;
  tile.tile_x = tx;
  tile.tile_y = ty;
  tile.resolution = 0.05f;
  tile.width = tile.height = grid::tile_side;
  const int last = tiles * grid::tile_side - 1;
  const grid::CellBox box = grid::cells_of_tile({tx, ty});
  for (int y = box.y; y < box.y + box.rows; ++y)
    for (int x = box.x; x < box.x + box.columns; ++x)
      tile.data.push_back(x == 0 || y == 0 || x == last || y == last ? std::int8_t{100} : std::int8_t{0});
  return tile;
}

TEST(FrontierComponent, TwoRobotsNeverDriveToTheSameFrontierUntilAllIsExplored) {
  constexpr double separation = 2.0, tile_length = 3.2, step = 1.0;  // m
  std::array<Explorer, 2> robots = {Explorer{.name = "a"}, Explorer{.name = "z"}};
  std::array<std::array<bool, 6>, 6> seen{};
  int both_drove = 0, steps = 0;
  const auto done = [](const Explorer& robot) {
    const auto* claim = robot.harness.latest<FrontierClaim>("claim");
    return claim && claim->state == ExplorationState::EXPLORATION_DONE;
  };
  while (steps < 200 && !(done(robots[0]) && done(robots[1]))) {
    ++steps;
    for (int ty = 0; ty < 6; ++ty)
      for (int tx = 0; tx < 6; ++tx) {
        const Vector2 middle((tx + 0.5) * tile_length, (ty + 0.5) * tile_length);
        bool& known = seen[static_cast<std::size_t>(ty)][static_cast<std::size_t>(tx)];
        if (known || ((middle - robots[0].at).norm() > 3.0 && (middle - robots[1].at).norm() > 3.0)) continue;
        known = true;
        for (Explorer& robot : robots) robot.harness.feed("tiles", floor_tile(tx, ty));
      }
    for (Explorer& robot : robots) be_at(robot.harness, robot.at.x(), robot.at.y(), 500ms);
    // Until nobody has anything to say any more.
    for (bool said = true; std::exchange(said, false);) {
      for (std::size_t i = 0; i < 2; ++i)
        for (const auto& sample : robots[i].harness.take<FrontierClaim>("claim")) {
          FrontierClaim claim = *sample;
          claim.robot = robots[i].name;
          robots[1 - i].harness.feed("claims", claim);
          said = true;
        }
      for (Explorer& robot : robots) robot.harness.advance(10ms);
    }
    const auto first = robots[0].choice(), second = robots[1].choice();
    if (first && second) {
      ++both_drove;
      EXPECT_GE((*first - *second).norm(), separation) << "step " << steps;
    }
    for (Explorer& robot : robots)
      if (const auto place = robot.choice()) {
        const Vector2 way = *place - robot.at;
        robot.at += std::min(1.0, step / std::max(way.norm(), 1e-9)) * way;
      }
  }
  EXPECT_TRUE(done(robots[0]) && done(robots[1])) << "after " << steps << " steps";
  EXPECT_GT(both_drove, 5);
}

TEST(FrontierComponent, EndsTheRunWhenAllAreDoneAndWritesItsFigures) {
  const Folder folder;
  Harness harness("exploration/frontier", {{"end_run", true}}, folder.path());
  see_room(harness, false, false);
  harness.feed("claims", claim_of("r2/explorer", 6.1, 3.0, harness.now()));
  be_at(harness, 5, 3);
  EXPECT_EQ(harness.latest<FrontierClaim>("claim")->state, ExplorationState::EXPLORATION_DONE);
  EXPECT_FALSE(harness.finished()) << "the other one still drives";
  FrontierClaim done = claim_of("r2/explorer", 0, 0, harness.now());
  done.state = ExplorationState::EXPLORATION_DONE;
  harness.feed("claims", done);
  be_at(harness, 5, 3);
  EXPECT_TRUE(harness.finished());
  harness.end();
  const std::string figures = text_of(folder.path() / "figures-subject.json");
  EXPECT_NE(figures.find("\"explored\": true, \"explored_after_s\": 0.5"), std::string::npos) << figures;
  EXPECT_NE(figures.find("\"area_m2\": 29.16"), std::string::npos) << figures;
}

TEST(FrontierComponent, SaysWhatItLacks) {
  Harness harness("exploration/frontier");
  harness.advance(4s);
  EXPECT_NE(harness.state(), ComponentState::degraded) << "a map takes its time";
  harness.advance(2s);
  EXPECT_EQ(harness.reason(), "odom: nothing received yet");
  be_at(harness, 5, 3);
  EXPECT_EQ(harness.reason(), "tiles: nothing received yet");
  see_room(harness);
  be_at(harness, std::nan(""), 3);
  EXPECT_EQ(harness.reason(), "odom: the pose is not finite");
  MapTile wrong;
  wrong.resolution = 0.1f;
  harness.feed("tiles", wrong);
  be_at(harness, 5, 3);
  EXPECT_EQ(harness.reason(), "tiles: cells of another size are left out");
  EXPECT_TRUE(harness.latest<PoseStamped>("goal")) << "it goes on with the others";
}

}  // namespace
}  // namespace kervan::test
