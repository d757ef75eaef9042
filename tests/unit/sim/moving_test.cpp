// What moves along a script, and what is too low to be seen.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/simulation.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

constexpr double nose = 0.211;  // m from base_link of a P3-DX

/// A disc that goes from (0, 0) to (4, 0) in four seconds, a second after the start.
MovingObstacle cart() {
  return {.name = "cart", .outline = disc_outline(0.3), .path = {{1s, {0.0, 0.0, 0.0}}, {5s, {4.0, 0.0, 0.0}}}};
}

Simulation with(std::vector<MovingObstacle> moving, std::vector<RobotSetup> robots) {
  return {std::make_shared<const World>(Obstacles{.moving = std::move(moving)}), std::move(robots), 1};
}

void wait(Simulation& simulation, Duration time, Duration step = tick) {
  for (const Duration end = simulation.now() + time; simulation.now() < end;) simulation.step(step);
}

double gap(const Simulation& simulation, std::size_t robot, std::size_t obstacle) {
  Bodies bodies;
  bodies.add("", simulation.moving()[obstacle].obstacle().outline, simulation.moving()[obstacle].pose());
  const Body& body = simulation.robots()[robot].body();
  return clearance(bodies, 0, body.outline(), body.pose()).distance;
}

TEST(MovingObstacle, IsWhereItsScriptSays) {
  MovingObstacle door{.name = "door",
                      .outline = rectangle_outline({0.8, 0.04}),
                      .path = {{2s, {1.0, 2.0, 0.0}}, {4s, {3.0, 2.0, 2.0 * pi}}, {5s, {1.0, 2.0, 2.0 * pi}}}};
  EXPECT_EQ(pose_at(door, 0s), (Pose2{1.0, 2.0, 0.0}));
  EXPECT_EQ(pose_at(door, 2s), (Pose2{1.0, 2.0, 0.0}));
  EXPECT_EQ(pose_at(door, 3s), (Pose2{2.0, 2.0, pi})) << "it turns through what is written";
  EXPECT_EQ(pose_at(door, 4500ms), (Pose2{2.0, 2.0, 2.0 * pi}));
  EXPECT_EQ(pose_at(door, 60s), (Pose2{1.0, 2.0, 2.0 * pi}));
  door.repeat = true;
  EXPECT_EQ(pose_at(door, 5s), (Pose2{1.0, 2.0, 0.0}));
  EXPECT_EQ(pose_at(door, 6s), (Pose2{2.0, 2.0, pi}));
  EXPECT_EQ(pose_at(door, 3s + 3000s), (Pose2{2.0, 2.0, pi})) << "a thousand rounds later";
}

TEST(MovingObstacle, CannotBeWithoutAPathThatMakesSense) {
  const auto refusal = [](void (*change)(MovingObstacle&)) {
    MovingObstacle obstacle = cart();
    change(obstacle);
    try {
      World({.moving = {obstacle}});
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("nothing was refused");
  };
  EXPECT_EQ(refusal([](MovingObstacle& m) { m.name.clear(); }), "a moving obstacle needs a name");
  EXPECT_EQ(refusal([](MovingObstacle& m) { m.path.clear(); }), "moving obstacle cart: its path needs a waypoint");
  EXPECT_EQ(refusal([](MovingObstacle& m) { m.path[0].at = -1s; }),
            "moving obstacle cart: its path must not begin before 0");
  EXPECT_EQ(refusal([](MovingObstacle& m) { m.path[1].pose.yaw = std::nan(""); }),
            "moving obstacle cart: its path must be finite");
  EXPECT_EQ(refusal([](MovingObstacle& m) { m.path[1].at = 1s; }),
            "moving obstacle cart: the times of its path must grow");
  EXPECT_EQ(refusal([](MovingObstacle& m) { m.repeat = true; }),
            "moving obstacle cart: a path that repeats must end where it began");
  EXPECT_THROW(World({.moving = {cart(), cart()}}), std::invalid_argument) << "two of one name";
}

TEST(MovingObstacle, IsSeenWhereItIsAfterTheStep) {
  RobotSetup setup = perfect("r1", {-1.0, 0.0, 0.0});
  setup.sonar.rays = 1;
  setup.sonar_period = setup.laser_period = tick;
  setup.laser = {.noise = 0.0};
  setup.model.laser = LaserMount{.pose = {}, .beams = 3, .field_of_view = 0.2, .max_range = 8.0};
  Simulation simulation = with({cart()}, {setup});
  EXPECT_NEAR(simulation.robots()[0].laser().ranges[1], 0.7, 1e-9);
  for (int i = 0; i < 500; ++i) {
    simulation.step(tick);
    const double x = std::clamp(seconds(simulation.now()) - 1.0, 0.0, 4.0);
    EXPECT_NEAR(simulation.moving()[0].pose().x, x, 1e-9);
    EXPECT_NEAR(simulation.robots()[0].laser().ranges[1], x + 0.7, 1e-9);
    const double ahead = x + 1.0 - 0.166 - 0.3;
    EXPECT_GE(simulation.robots()[0].sonar().ranges[3], ahead) << "10 degrees from straight ahead";
    if (x == 0.0) {
      EXPECT_LT(simulation.robots()[0].sonar().ranges[3], ahead + 0.1);
    }
  }
}

TEST(MovingObstacle, ARobotIsStoppedByItAsByAWall) {
  Simulation simulation = with({cart()}, {perfect("r1", {6.0, 0.0, pi})});
  for (int i = 0; i < 1000; ++i) {
    simulation.command(0, {0.5, 0.0});
    simulation.step(tick);
    ASSERT_GT(gap(simulation, 0, 0), 0.0);
  }
  const Body& body = simulation.robots()[0].body();
  EXPECT_TRUE(body.touching());
  EXPECT_EQ(body.contacts(), 1u);
  EXPECT_EQ(body.last_contact().other, "cart");
  EXPECT_LT(body.min_clearance(), 1e-5);
}

TEST(MovingObstacle, WaitsForARobotInItsWayAndGoesOnLater) {
  for (const Duration step : {Duration(10ms), Duration(100ms), Duration(2s)}) {
    Simulation simulation = with({cart()}, {perfect("r1", {2.0, 0.0, pi})});
    wait(simulation, 8s, step);
    const Robot& robot = simulation.robots()[0];
    EXPECT_NEAR(simulation.moving()[0].pose().x, 2.0 - nose - 0.3, 1e-5) << "it stands at the robot's nose";
    EXPECT_GT(gap(simulation, 0, 0), 0.0);
    EXPECT_EQ(robot.pose(), (Pose2{2.0, 0.0, pi})) << "nobody is pushed";
    EXPECT_EQ(robot.body().contacts(), 1u) << "however long it waits";
    EXPECT_EQ(robot.body().last_contact().other, "cart");
    EXPECT_NEAR(robot.body().last_contact().point.x(), 2.0 - nose, 1e-5);
    EXPECT_TRUE(robot.body().touching());

    simulation.teleport("r1", {2.0, 2.0, 0.0});
    const double x = simulation.moving()[0].pose().x;
    wait(simulation, 2s, step);
    EXPECT_NEAR(simulation.moving()[0].pose().x, x + 2.0, 1e-5) << "it goes on from where it waited";
    EXPECT_FALSE(robot.body().touching());
  }
}

TEST(MovingObstacle, NeverJumpsOverARobotHoweverFastItIs) {
  MovingObstacle fast = cart();
  fast.path = {{0s, {-50.0, 0.05, 0.0}}, {1s, {50.0, 0.05, 0.0}}};
  Simulation simulation = with({fast}, {perfect("r1", {0.0, 0.0, 0.0})});
  wait(simulation, 2s, 100ms);
  EXPECT_LT(simulation.moving()[0].pose().x, -0.5);
  EXPECT_EQ(simulation.robots()[0].body().contacts(), 1u);
}

TEST(MovingObstacle, OneThatComesCloseWithoutTouchingCountsForTheClearance) {
  Simulation simulation = with({cart()}, {perfect("r1", {2.0, 0.7, 0.0})});
  wait(simulation, 8s);
  EXPECT_EQ(simulation.robots()[0].body().contacts(), 0u);
  EXPECT_NEAR(simulation.robots()[0].body().min_clearance(), 0.7 - 0.2 - 0.3, 1e-3);
  EXPECT_NEAR(simulation.moving()[0].pose().x, 4.0, 1e-12);
}

TEST(MovingObstacle, MindsNeitherWallsNorOthersOfItsKind) {
  MovingObstacle other = cart();
  other.name = "other";
  std::swap(other.path[0].pose, other.path[1].pose);
  Simulation simulation(
      std::make_shared<const World>(Obstacles{.segments = {{{2.0, -1.0}, {2.0, 1.0}}}, .moving = {cart(), other}}), {},
      1);
  wait(simulation, 6s);
  EXPECT_NEAR(simulation.moving()[0].pose().x, 4.0, 1e-12);
  EXPECT_NEAR(simulation.moving()[1].pose().x, 0.0, 1e-12);
}

TEST(MovingObstacle, KeepsItsPlaceAndItsNameFromRobots) {
  Simulation simulation = with({cart()}, {});
  EXPECT_THROW(simulation.spawn(perfect("r1", {0.2, 0.0, 0.0})), NoRoom);
  try {
    simulation.spawn(perfect("cart", {0.0, 3.0, 0.0}));
    FAIL() << "nothing was refused";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "robot cart has the name of a moving obstacle");
  }
}

TEST(MovingObstacle, RobotsInItsPathGoTheSameWayInEveryRun) {
  const auto run = [](int threads, bool other_way_round) {
    MovingObstacle bus{.name = "bus",
                       .outline = rectangle_outline({1.2, 0.5}),
                       .path = {{0s, {-2.0, 0.5, 0.0}}, {4s, {4.0, 0.8, 1.0}}, {8s, {-2.0, 0.5, 0.0}}},
                       .repeat = true};
    std::vector<RobotSetup> robots;
    for (int i = 0; i < 20; ++i)
      robots.push_back(perfect("r" + std::to_string(i), {0.8 * (i % 5), 0.8 * (i / 5), 0.7 * i}));
    if (other_way_round) std::reverse(robots.begin(), robots.end());
    Simulation simulation(std::make_shared<const World>(Obstacles{.moving = {bus}}), robots, 1, threads);
    std::uint64_t met = 0;
    for (int i = 0; i < 300; ++i) {
      for (std::size_t r = 0; r < robots.size(); ++r) simulation.command(r, {0.3, 0.1 * (robots[r].name.back() - '4')});
      simulation.step(tick);
      for (std::size_t r = 0; r < robots.size(); ++r)
        if (gap(simulation, r, 0) < 2e-6) ++met;
    }
    EXPECT_GT(met, 0u) << "it was in somebody's way";
    std::vector<double> end{simulation.moving()[0].pose().x, simulation.moving()[0].pose().yaw};
    for (int i = 0; i < 20; ++i) {
      const Robot& robot = simulation.robots()[simulation.find("r" + std::to_string(i)).value()];
      end.insert(end.end(), {robot.pose().x, robot.pose().y, robot.pose().yaw, robot.body().min_clearance()});
      end.insert(end.end(), robot.sonar().ranges.begin(), robot.sonar().ranges.end());
    }
    return end;
  };
  const auto first = run(1, false);
  EXPECT_EQ(run(2, false), first);
  EXPECT_EQ(run(1, true), first);
}

TEST(LowObstacle, IsMetByTheBodyAndByNoRay) {
  const Shapes low{.segments = {{{1.0, -2.0}, {1.0, 2.0}}},
                   .circles = {{{0.0, 1.5}, 0.2}},
                   .boxes = {{{0.0, -1.5, 0.3}, {0.4, 0.4}}}};
  const auto world = std::make_shared<const World>(Obstacles{.low = low});
  RobotSetup setup = perfect("r1", {});
  setup.model.laser = LaserMount{.pose = {}, .beams = 181, .field_of_view = 1.9 * pi, .max_range = 8.0};
  Simulation simulation(world, {setup}, 1);
  for (const double range : simulation.robots()[0].sonar().ranges) EXPECT_EQ(range, infinity);
  for (const double range : simulation.robots()[0].laser().ranges) EXPECT_EQ(range, infinity);
  EXPECT_FALSE(world->cast({{0.0, 0.0}, {1.0, 0.0}}));
  EXPECT_NEAR(world->nearest({0.0, 0.0})->distance, 1.0, 1e-12);
  for (const Pose2& inside : {Pose2{0.0, 1.5, 0.0}, {0.0, -1.5, 0.0}, {1.0, 0.0, 0.0}})
    EXPECT_EQ(world->clearance(p3dx().outline, inside).distance, 0.0);
  for (int i = 0; i < 600; ++i) {
    simulation.command(0, {0.5, 0.0});
    simulation.step(tick);
  }
  EXPECT_NEAR(simulation.robots()[0].pose().x, 1.0 - nose, 1e-5);
  EXPECT_EQ(simulation.robots()[0].body().contacts(), 1u);
  EXPECT_EQ(simulation.robots()[0].body().last_contact().other, "");
}

TEST(LowObstacle, AHighOneBehindItIsSeenOverIt) {
  const World world({.segments = {{{2.0, -2.0}, {2.0, 2.0}}}, .low = {.segments = {{{1.0, -2.0}, {1.0, 2.0}}}}});
  EXPECT_NEAR(world.cast({{0.0, 0.0}, {1.0, 0.0}})->distance, 2.0, 1e-12);
  EXPECT_EQ(world.segments().size(), 1u);
  EXPECT_EQ(world.low().segments().size(), 1u);
  EXPECT_THROW(World({.low = {.circles = {{{0.0, 0.0}, -1.0}}}}), std::invalid_argument);
}

}  // namespace
}  // namespace kervan::sim
