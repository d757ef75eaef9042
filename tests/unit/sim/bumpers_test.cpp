// Bumpers: a segment is pressed by what touches it, and by nothing else.
#include "sim/bumpers.hpp"

#include <gtest/gtest.h>

#include "sim/simulation.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;
using Pressed = std::vector<bool>;

/// Which segments of a P3-DX with all its bumpers are pressed at the origin; 0..4 before, from right to left, 5..9
/// behind, from left to right.
std::vector<std::size_t> pressed_by(Obstacles obstacles, double touch_range = 0.02) {
  Pressed pressed;
  Bumpers(with_bumpers(p3dx(), BumperSet::both), touch_range).feel(World(std::move(obstacles)), Pose2{}, pressed);
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < pressed.size(); ++i)
    if (pressed[i]) numbers.push_back(i);
  return numbers;
}

using Numbers = std::vector<std::size_t>;

TEST(Bumpers, OnlyTheSegmentThatIsTouchedIsPressed) {
  const std::vector<Pose2> segments = fitted_bumpers(with_bumpers(p3dx(), BumperSet::both));
  ASSERT_EQ(segments.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) {
    // A thin rod before the middle of the segment.
    const Vector2 near = segments[i] * Vector2(0.015, 0.0), far = segments[i] * Vector2(0.035, 0.0);
    EXPECT_EQ(pressed_by({.circles = {{near, 0.005}}}), Numbers{i});
    EXPECT_EQ(pressed_by({.circles = {{far, 0.005}}}), Numbers{}) << "3 cm before segment " << i;
  }
}

TEST(Bumpers, AWallPressesThoseThatItTouches) {
  const auto wall = [](double x) { return Obstacles{.segments = {{{x, -3.0}, {x, 3.0}}}}; };
  EXPECT_EQ(pressed_by(wall(0.26 + 0.019)), (Numbers{2})) << "the neighbours end 3 mm behind the nose";
  EXPECT_EQ(pressed_by(wall(0.26 + 0.001)), (Numbers{1, 2, 3}));
  EXPECT_EQ(pressed_by(wall(0.26 + 0.021)), Numbers{});
  EXPECT_EQ(pressed_by(wall(-0.34 - 0.019)), Numbers{7});
  EXPECT_EQ(pressed_by({.segments = {{{-3.0, 0.26}, {3.0, 0.26}}}}), (Numbers{4, 5})) << "a wall to the left";
}

TEST(Bumpers, TheTouchRangeIsTheirs) {
  const Obstacles rod{.circles = {{{0.26 + 0.05, 0.0}, 0.005}}};
  EXPECT_EQ(pressed_by(rod, 0.044), Numbers{});
  EXPECT_EQ(pressed_by(rod, 0.046), Numbers{2});
  EXPECT_THROW(Bumpers(p3dx(), 0.0), std::invalid_argument);
}

RobotSetup wearing(std::string name, Pose2 start, BumperSet set) {
  RobotSetup setup = perfect(std::move(name), start);
  setup.model = with_bumpers(setup.model, set);
  return setup;
}

void drive(Simulation& simulation, std::size_t robot, const Twist2& wanted, Duration time) {
  for (const Duration end = simulation.now() + time; simulation.now() < end;) {
    simulation.command(robot, wanted);
    simulation.step(tick);
  }
}

TEST(Bumpers, ARobotThatWearsThemIsLongerByThem) {
  const auto wall = std::make_shared<const World>(Obstacles{.segments = {{{2.0, -5.0}, {2.0, 5.0}}}});
  Simulation simulation(wall, {wearing("r1", {}, BumperSet::front)}, 1);
  drive(simulation, 0, {0.5, 0.0}, 8s);
  EXPECT_NEAR(simulation.robots()[0].pose().x, 2.0 - 0.26, 1e-5);
}

TEST(Bumpers, ArePressedFromTheTouchRangeOnAndUntilTheRobotHasLeft) {
  const auto wall = std::make_shared<const World>(Obstacles{.segments = {{{2.0, -5.0}, {2.0, 5.0}}}});
  Simulation simulation(wall, {wearing("r1", {1.0, 0.0, 0.0}, BumperSet::both)}, 1);
  const Robot& robot = simulation.robots()[0];
  for (const double speed : {0.5, -0.3})
    for (int i = 0; i < 500; ++i) {
      drive(simulation, 0, {speed, 0.0}, tick);
      const double distance = 2.0 - robot.pose().x - 0.26;
      EXPECT_EQ(robot.pressed()[2], distance <= 0.02) << distance;
      EXPECT_FALSE(robot.pressed()[7]) << "the rear one";
    }
}

TEST(Bumpers, FeelOtherRobots) {
  Simulation simulation(std::make_shared<const World>(Obstacles{}),
                        {wearing("r1", {0.0, 0.0, 0.0}, BumperSet::rear), perfect("r2", {-2.0, 0.0, 0.0})}, 1);
  EXPECT_EQ(simulation.robots()[0].pressed(), Pressed(5));
  drive(simulation, 1, {0.5, 0.0}, 6s);
  const Pressed& pressed = simulation.robots()[0].pressed();
  EXPECT_TRUE(pressed[2]) << "r2 has driven into its tail";
  EXPECT_FALSE(pressed[0] || pressed[4]);
  drive(simulation, 1, {-0.5, 0.0}, 2s);
  EXPECT_EQ(simulation.robots()[0].pressed(), Pressed(5));
}

TEST(Bumpers, FeelLowObstaclesThatSonarsLookOver) {
  const auto step = std::make_shared<const World>(Obstacles{.low = {.segments = {{{0.27, -5.0}, {0.27, 5.0}}}}});
  Simulation simulation(step, {wearing("r1", {}, BumperSet::front)}, 1);
  EXPECT_TRUE(simulation.robots()[0].pressed()[2]);
  for (const double range : simulation.robots()[0].sonar().ranges) EXPECT_EQ(range, infinity);
}

TEST(Bumpers, ArePressedAtTheStartIfSomethingIsThere) {
  const auto wall = std::make_shared<const World>(Obstacles{.segments = {{{0.27, -5.0}, {0.27, 5.0}}}});
  EXPECT_TRUE(Simulation(wall, {wearing("r1", {}, BumperSet::front)}, 1).robots()[0].pressed()[2]);
}

TEST(Bumpers, OfASynchroDriveStayWhereTheBodyHasThem) {
  // The wall is where the body's front looks; base_link turns away from it, and the same segments stay pressed.
  RobotSetup setup{.name = "r1",
                   .model = with_bumpers(load_robot_model(KERVAN_SIM_FOLDER "/robots/k2a.yaml"), BumperSet::both),
                   .start = {}};
  const auto wall = std::make_shared<const World>(Obstacles{.segments = {{{0.41, -5.0}, {0.41, 5.0}}}});
  Simulation simulation(wall, {setup}, 1);
  const Pressed before = simulation.robots()[0].pressed();
  EXPECT_TRUE(before[5] && before[6]);
  drive(simulation, 0, {0.0, 1.0}, 2s);
  EXPECT_GT(simulation.robots()[0].pose().yaw, 1.0);
  EXPECT_EQ(simulation.robots()[0].pressed(), before);
}

}  // namespace
}  // namespace kervan::sim
