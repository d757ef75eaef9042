#include "components/control/vff.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kervan::control {
namespace {

using geometry::Vector2;

constexpr double pi = std::numbers::pi;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int middle = window_side / 2;

/// A window around the origin in whose middle a robot stands.
CertaintyWindow empty_window() {
  CertaintyWindow window;
  window.origin = Vector2::Constant(-(middle + 0.5) * window.resolution);
  return window;
}

/// Columns and rows count from the middle cell.
std::uint8_t& cell(CertaintyWindow& window, int column, int row) {
  return window.cells[static_cast<std::size_t>((middle + row) * window_side + middle + column)];
}

CertaintyWindow window_with(int column, int row, std::uint8_t certainty) {
  CertaintyWindow window = empty_window();
  cell(window, column, row) = certainty;
  return window;
}

TEST(Vff, Equation1PushesAwayFromTheCellWithTheSquareOfTheDistance) {
  const Vector2 ahead = repulsion_of(window_with(5, 0, 15), 0.02);  // 0.5 m ahead
  EXPECT_NEAR(ahead.x(), -0.02 * 15 / 0.25, 1e-6);
  EXPECT_NEAR(ahead.y(), 0.0, 1e-6);
  const Vector2 twice_as_far = repulsion_of(window_with(10, 0, 15), 0.02);
  EXPECT_NEAR(twice_as_far.x(), ahead.x() / 4.0, 1e-6);
  const Vector2 aside = repulsion_of(window_with(-3, -4, 6), 0.02);  // 0.5 m behind to the right
  EXPECT_NEAR(aside.x(), 0.02 * 6 / 0.25 * 0.6, 1e-6);
  EXPECT_NEAR(aside.y(), 0.02 * 6 / 0.25 * 0.8, 1e-6);
}

TEST(Vff, Equation1HasNoDirectionInTheRobotsOwnCell) {
  EXPECT_EQ(repulsion_of(window_with(0, 0, 15), 0.02), Vector2(0.0, 0.0));
}

TEST(Vff, Equation2SumsTheWholeWindow) {
  // As the formula has it, cell by cell.
  CertaintyWindow window = empty_window();
  Vector2 sum = Vector2::Zero();
  std::uint32_t state = 1;
  for (int row = -middle; row <= middle; ++row)
    for (int column = -middle; column <= middle; ++column) {
      state = state * 1664525u + 1013904223u;
      cell(window, column, row) = static_cast<std::uint8_t>(state >> 28);
      const Vector2 at = 0.1 * Vector2(column, row);
      if (at.norm() > 0.0) sum -= 0.02 * cell(window, column, row) / at.squaredNorm() * at.normalized();
    }
  EXPECT_NEAR((repulsion_of(window, 0.02) - sum).norm(), 0.0, 1e-4 * sum.norm() + 1e-4);
}

TEST(Vff, Equation2OfASymmetricWindowIsZero) {
  CertaintyWindow window = empty_window();
  window.cells.fill(15);
  EXPECT_NEAR(repulsion_of(window, 0.02).norm(), 0.0, 1e-3);
}

TEST(Vff, Equation3PullsWithTheSameForceFromEverywhere) {
  EXPECT_NEAR((attraction_of({1.0, 1.0}, {4.0, 5.0}, 2.0) - Vector2(1.2, 1.6)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((attraction_of({1.0, 1.0}, {1.03, 1.04}, 2.0) - Vector2(1.2, 1.6)).norm(), 0.0, 1e-12);
  EXPECT_EQ(attraction_of({1.0, 1.0}, {1.0, 1.0}, 2.0), Vector2(0.0, 0.0));
}

VffParams unfiltered() { return {.tau = 0.1}; }

TEST(Vff, Equation4KnowsAllFourQuadrants) {
  for (const double theta : {0.1, 2.0, -2.0, -0.1}) {
    VirtualForceField field({.k_s = 0.1, .tau = 0.1});
    const VffStep step = field.step({{}, {0.5, 0.0}}, 9.0 * geometry::heading(theta), empty_window());
    EXPECT_NEAR(step.twist.angular, 0.1 * theta, 1e-12);
  }
}

TEST(Vff, Equation5TurnsTheShortWay) {
  VirtualForceField field(unfiltered());
  const VffStep step = field.step({{0.0, 0.0, 3.0}, {0.5, 0.0}}, 9.0 * geometry::heading(-3.0), empty_window());
  EXPECT_NEAR(step.twist.angular, 2.0 * (2.0 * pi - 6.0), 1e-9);
}

TEST(Vff, Equation5TurnsNoFasterThanTheDrive) {
  VirtualForceField field(unfiltered());
  EXPECT_EQ(field.step({{}, {0.5, 0.0}}, {-1.0, 0.1}, empty_window()).twist.angular, 2.094);
  EXPECT_EQ(field.step({{}, {0.5, 0.0}}, {-1.0, -0.1}, empty_window()).twist.angular, -2.094);
}

TEST(Vff, Equation6LeavesNoCellOutBetweenTwoSteps) {
  EXPECT_GT(CertaintyWindow().resolution, VffParams().period * VffParams().v_max);  // 0.1 m > 0.078 m
}

TEST(Vff, Equation7RisesAsAFirstOrderLag) {
  double turning = 0.0;
  for (const double golden : {.250, .438, .578, .684, .763}) {
    turning = low_passed({}, 1.0, turning);
    EXPECT_NEAR(turning, golden, 0.0006);
  }
  EXPECT_EQ(low_passed(unfiltered(), 1.0, 0.3), 1.0) << "a time constant of one period filters nothing";
}

TEST(Vff, Equation7IsForgottenWhenTheRobotStands) {
  VirtualForceField field({});
  const auto turn = [&] { return field.step({{}, {0.5, 0.0}}, {0.0, 9.0}, empty_window()).twist.angular; };
  const double first = turn();
  EXPECT_GT(turn(), first);
  field.reset();
  EXPECT_EQ(turn(), first);
}

TEST(Vff, Equation8HasThePapersFactors) {
  EXPECT_DOUBLE_EQ(damping(0.25, -1.0), 1.0);  // head-on
  EXPECT_DOUBLE_EQ(damping(0.25, 0.0), 0.25);  // along
  EXPECT_DOUBLE_EQ(damping(0.25, 1.0), -0.5);  // away: it attracts
  EXPECT_DOUBLE_EQ(damping(1.0, 0.7), 1.0);    // not damped at all
}

TEST(Vff, Equation8DampsTheForceThatSteers) {
  VirtualForceField field({});
  const VffStep step =
      field.step({{}, {0.7, 0.0}}, {9.0, 0.0}, window_with(0, -10, 15));  // 1 m to the right, drives along it
  EXPECT_NEAR(step.repulsion.y(), 0.3, 1e-6);
  EXPECT_NEAR(step.damped.y(), 0.25 * 0.3, 1e-6);
  EXPECT_NEAR(step.resultant.y(), 0.25 * 0.3, 1e-6);
  EXPECT_NEAR(step.resultant.x(), 1.0, 1e-6);
}

TEST(Vff, Equation9IsTheAngleBetweenVelocityAndRepulsion) {
  EXPECT_NEAR(motion_against(0.0, 0.5, {-2.0, 0.0}), -1.0, 1e-12);
  EXPECT_NEAR(motion_against(pi / 2, 0.5, {-2.0, 0.0}), 0.0, 1e-12);
  EXPECT_NEAR(motion_against(pi, 0.5, {-1.0, 1.0}), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(motion_against(0.0, -0.5, {-2.0, 0.0}), 1.0, 1e-12) << "driving backwards, away from it";
}

TEST(Vff, Equation9IsHeadOnWhereItIsUndefined) {
  EXPECT_EQ(motion_against(0.0, 0.0, {0.0, 1.0}), -1.0);
  EXPECT_EQ(motion_against(0.0, 0.5, {0.0, 0.0}), -1.0);
}

TEST(Vff, Equation10DrivesAtFullSpeedWithoutRepulsion) {
  EXPECT_EQ(speed_of({}, 0.0, -1.0), 0.78);
  EXPECT_EQ(speed_of({}, 0.05, -1.0), 0.78) << "nor within the dead-band";
}

TEST(Vff, Equation10SlowsDownHeadOnAndNeverStops) {
  EXPECT_NEAR(speed_of({}, 0.3, 0.0), 0.78, 1e-12);
  EXPECT_NEAR(speed_of({}, 0.3, -0.5), 0.39, 1e-12);
  EXPECT_NEAR(speed_of({}, 0.3, 0.5), 0.39, 1e-12);
  EXPECT_EQ(speed_of({}, 0.3, -1.0), 0.2);
  EXPECT_EQ(speed_of({.v_max = 0.1}, 0.3, -1.0), 0.1) << "not faster than the most";
}

TEST(Vff, StepsAreStraightWithoutAnythingAround) {
  VirtualForceField field({});
  const VffStep step = field.step({}, {9.0, 0.0}, empty_window());
  EXPECT_EQ(step.outcome, Outcome::drives);
  EXPECT_EQ(step.twist, (geometry::Twist2{0.78, 0.0}));
}

TEST(Vff, DoesNotTurnOnTheTarget) {
  VirtualForceField field({});
  EXPECT_EQ(field.step({{}, {0.5, 0.0}}, {0.0, 0.0}, empty_window()).twist.angular, 0.0);
}

TEST(Vff, RefusesWhatIsNotFiniteOrNoCertaintyInASentence) {
  const auto fault = [](const RobotState& robot, const Vector2& target, const CertaintyWindow& w) {
    VirtualForceField field({});
    const VffStep step = field.step(robot, target, w);
    EXPECT_EQ(step.twist, geometry::Twist2{});
    EXPECT_EQ(step.outcome, Outcome::fault);
    return step.why;
  };
  const Vector2 target(9.0, 0.0);
  const CertaintyWindow window = empty_window();
  EXPECT_EQ(fault({{nan, 0.0, 0.0}}, target, window), "the pose is not finite");
  EXPECT_EQ(fault({{0.0, 0.0, nan}}, target, window), "the pose is not finite");
  EXPECT_EQ(fault({{}, {nan, 0.0}}, target, window), "the speed is not finite");
  EXPECT_EQ(fault({}, {9.0, nan}, window), "the target is not finite");
  EXPECT_EQ(fault({{0.06, 0.0, 0.0}}, target, window), "the robot is not in the middle of the window");
  EXPECT_EQ(fault({}, target, window_with(3, 3, 16)), "a cell of the window is more certain than 15");
  CertaintyWindow without_size = window;
  without_size.resolution = 0.0;
  EXPECT_EQ(fault({}, target, without_size), "the cells of the window have no size");
  CertaintyWindow nowhere = window;
  nowhere.origin.x() = nan;
  EXPECT_EQ(fault({}, target, nowhere), "the robot is not in the middle of the window");
}

TEST(Vff, CutsTheWindowAroundTheRobotsCell) {
  grid::Grid<grid::Certainty> cells(0.1, {}, std::size_t{1} << 20);
  ASSERT_EQ(cells.cover({0, 0, 64, 64}), grid::Growth::grown);
  cells.place({5, 2})->raise();
  CertaintyWindow window;
  window.cells.fill(9);
  cut_window(cells, {0.05, -0.25}, window);  // in cell (0, -3), so most of the window is outside of the grid
  EXPECT_EQ(cell(window, 5, 5), 3);
  EXPECT_EQ(std::count(window.cells.begin(), window.cells.end(), 0), static_cast<int>(window_cells) - 1);
  EXPECT_NEAR((window.origin - Vector2(-1.6, -1.9)).norm(), 0.0, 1e-12);
  EXPECT_EQ(VirtualForceField({}).step({{0.05, -0.25, 0.0}}, {9.0, 0.0}, window).why, "");
}

TEST(Vff, CutsAnEmptyWindowFarFromTheGrid) {
  grid::Grid<grid::Certainty> cells(0.1, {}, std::size_t{1} << 20);
  CertaintyWindow window;
  window.cells.fill(9);
  cut_window(cells, {1e6, -1e6}, window);
  EXPECT_EQ(std::count(window.cells.begin(), window.cells.end(), 0), static_cast<int>(window_cells));
  EXPECT_EQ(VirtualForceField({}).step({{1e6, -1e6, 0.0}}, {9.0, 0.0}, window).why, "");
}

}  // namespace
}  // namespace kervan::control
