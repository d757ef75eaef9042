// No step of a control law allocates, once it has run.
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <numbers>
#include <vector>

#include "components/control/dwa.hpp"
#include "components/control/nearest_echo.hpp"
#include "components/control/potential_field.hpp"
#include "components/control/pursuit.hpp"
#include "components/control/recovery.hpp"
#include "components/control/route_follower.hpp"
#include "components/control/seen_points.hpp"
#include "components/control/vff.hpp"
#include "components/control/vfh_openings.hpp"
#include "components/control/vfh_plus.hpp"
#include "tests/unit/allocations.hpp"

namespace kervan::control {
namespace {

using namespace std::chrono_literals;
using geometry::Vector2;

constexpr double pi = std::numbers::pi;
constexpr int steps = 100;

/// A robot that drives a slow circle.
RobotState robot_at(int step) { return {{0.01 * step, 0.0, geometry::wrap_angle(0.06 * step)}, {0.5, 0.6}}; }

/// `drive` returns the turning rate of a step. All turn now and then, or nothing would have been tested.
template <class Drive>
void expect_steady(const Drive& drive) {
  for (int i = 0; i < steps; ++i) drive(i);
  const std::size_t before = test::allocations();
  double turned = 0.0;
  for (int i = 0; i < steps; ++i) turned += std::abs(drive(i));
  EXPECT_EQ(test::allocations() - before, 0u);
  EXPECT_GT(turned, 0.0);
}

/// Scans of a room of 4 m x 4 m around the origin, `beams` over half a turn.
class Room {
 public:
  explicit Room(std::size_t beams) : increment_(pi / static_cast<double>(beams - 1)) {
    for (int i = 0; i < steps; ++i) {
      const geometry::Pose2 robot = robot_at(i).pose;
      auto& ranges = ranges_.emplace_back(beams);
      for (std::size_t beam = 0; beam < beams; ++beam) {
        const Vector2 ray = geometry::heading(robot.yaw - 0.5 * pi + static_cast<double>(beam) * increment_);
        const Vector2 side(std::copysign(2.0, ray.x()), std::copysign(2.0, ray.y()));
        const Vector2 way = (side - robot.position()).cwiseQuotient(ray);
        ranges[beam] = static_cast<float>(way.minCoeff());
      }
    }
  }
  PlacedScan seen(int step) const {
    return {robot_at(step).pose, {-0.5 * pi, increment_, 0.05, 30.0, ranges_[static_cast<std::size_t>(step)]}};
  }

 private:
  double increment_;
  std::vector<std::vector<float>> ranges_;
};

TEST(ControlSteadyState, VffAllocatesNothing) {
  grid::Grid<grid::Certainty> cells(0.1, {}, std::size_t{1} << 20);
  ASSERT_EQ(cells.cover({-64, -64, 128, 128}), grid::Growth::grown);
  cells.place({9, 1})->raise();
  VirtualForceField field({});
  CertaintyWindow window;
  expect_steady([&](int i) {
    cut_window(cells, robot_at(i).pose.position(), window);
    return field.step(robot_at(i), {9.0, 0.0}, window).twist.angular;
  });
}

TEST(ControlSteadyState, PotentialFieldAllocatesNothing) {
  std::vector<SonarEcho> echoes;
  for (int i = 0; i < 16; ++i) echoes.push_back({{0.1, 0.0, 0.4 * i}, 0.6 + 0.1 * i});
  expect_steady([&](int i) {
    const geometry::Pose2 robot = robot_at(i).pose;
    const auto echo = nearest_echo(echoes, 5.0);
    return drive_along({}, force_at({}, robot.position(), {9.0, 0.0}, robot * *echo), robot.yaw).angular;
  });
}

TEST(ControlSteadyState, PursuitAllocatesNothing) {
  expect_steady([](int i) { return pursue({}, robot_at(i), {9.0, 0.0}).twist.angular; });
}

TEST(ControlSteadyState, VfhOpeningsAllocatesNothing) {
  for (const std::size_t beams : {181u, 721u}) {
    const Room room(beams);
    VfhOpenings law({.free_range = 1.5}, {});
    expect_steady([&](int i) { return law.step(robot_at(i), {9.0, 0.0}, room.seen(i)).twist.angular; });
  }
}

TEST(ControlSteadyState, VfhPlusAllocatesNothing) {
  for (const std::size_t beams : {181u, 721u}) {
    const Room room(beams);
    VfhPlus law({.remember = 3.0}, {});
    expect_steady([&](int i) { return law.step(robot_at(i), {9.0, 0.0}, room.seen(i)).twist.angular; });
  }
}

TEST(ControlSteadyState, DwaAllocatesNothing) {
  const Room room(721);
  SeenPoints seen({});
  DynamicWindow window({});
  Time now{};
  expect_steady([&](int i) {
    now += 50ms;
    const PlacedScan scan = room.seen(i);
    seen.look(scan.laser, scan.scan, now);
    return window.step(robot_at(i), {9.0, 0.0}, seen.points()).twist.angular;
  });
}

TEST(ControlSteadyState, FollowingARouteAllocatesNothing) {
  RouteFollower follower({.pass_within = 0.05});
  std::vector<Vector2> route;
  for (int i = 1; i < steps; ++i) route.emplace_back(0.01 * i, 0.0);
  follower.start(route);
  const std::size_t before = test::allocations();
  for (int i = 0; i < steps; ++i) follower.advance(robot_at(i).pose.position());
  EXPECT_EQ(test::allocations() - before, 0u);
  EXPECT_EQ(follower.index() + 1, follower.size());
}

TEST(ControlSteadyState, RecoveryOfARobotThatIsNotTrappedAllocatesNothing) {
  Recovery recovery({});
  Time now{};
  expect_steady([&](int i) {
    now += 100ms;
    const RobotState robot{{0.1 * i, 0.0, 0.0}, {1.0, 0.1}};
    const Recovering recovering = recovery.step(now, robot.pose, geometry::Vector2(99.0, 0.0), robot.twist, {});
    EXPECT_FALSE(recovering.twist);
    return robot.twist.angular;
  });
}

}  // namespace
}  // namespace kervan::control
