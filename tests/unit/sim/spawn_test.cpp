// Robots that come, go and are put elsewhere while the others drive on.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "sim/simulation.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

std::shared_ptr<const World> room() {
  return std::make_shared<const World>(Obstacles{.segments = {{{-5.0, -5.0}, {9.0, -5.0}},
                                                              {{9.0, -5.0}, {9.0, 5.0}},
                                                              {{9.0, 5.0}, {-5.0, 5.0}},
                                                              {{-5.0, 5.0}, {-5.0, -5.0}}}});
}

RobotSetup noisy(std::string name, Pose2 start) {
  RobotSetup setup = perfect(std::move(name), start);
  setup.sonar = {.noise = 0.01, .drop_out = 0.02};
  setup.odometry.drift = 0.03;
  return setup;
}

void command(Simulation& simulation, const std::string& name, const Twist2& wanted) {
  simulation.command(simulation.find(name).value(), wanted);
}

const Robot& robot(const Simulation& simulation, const std::string& name) {
  return simulation.robots()[simulation.find(name).value()];
}

std::vector<double> state(const Robot& robot) {
  std::vector<double> numbers{robot.pose().x,          robot.pose().y,          robot.pose().yaw,
                              robot.odometry().pose.x, robot.odometry().pose.y, robot.body().min_clearance(),
                              robot.speed().linear,    robot.speed().angular,   seconds(robot.sonar().stamp)};
  numbers.insert(numbers.end(), robot.sonar().ranges.begin(), robot.sonar().ranges.end());
  return numbers;
}

std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(Spawn, ANewRobotMeasuresAtOnceAndThenWhenItIsDue) {
  Simulation simulation(room(), {perfect("r1", {})}, 1);
  for (int i = 0; i < 23; ++i) simulation.step(tick);
  simulation.spawn(perfect("r2", {2.0, 0.0, 0.0}));
  EXPECT_EQ(simulation.find("r2"), 1u);
  EXPECT_EQ(robot(simulation, "r2").sonar().stamp, 230ms);
  EXPECT_EQ(robot(simulation, "r2").odometry().stamp, 230ms);
  EXPECT_EQ(robot(simulation, "r2").odometry().pose, (Pose2{2.0, 0.0, 0.0}));
  EXPECT_LT(robot(simulation, "r2").sonar().ranges[11], 2.0) << "it sees the other behind it";
  EXPECT_EQ(robot(simulation, "r1").sonar().stamp, 200ms) << "nobody else measures";
  for (int i = 0; i < 7; ++i) simulation.step(tick);
  EXPECT_EQ(robot(simulation, "r2").sonar().stamp, 300ms);
  EXPECT_LT(robot(simulation, "r1").sonar().ranges[3], 2.0) << "now the other one is seen";
}

TEST(Spawn, AtTheStartItIsTheSameAsAmongTheFirst) {
  const RobotSetup a = noisy("a", {}), b = noisy("b", {0.7, 0.3, 1.0}), c = noisy("c", {2.0, -1.0, 2.0});
  Simulation at_once(room(), {a, b, c}, 1), later(room(), {c}, 1);
  later.spawn(b);
  later.spawn(a);
  for (int i = 0; i < 300; ++i) {
    for (Simulation* simulation : {&at_once, &later})
      for (const char* name : {"a", "b", "c"}) command(*simulation, name, {0.4, 0.1});
    at_once.step(tick);
    later.step(tick);
  }
  for (const char* name : {"a", "b", "c"}) EXPECT_EQ(state(robot(at_once, name)), state(robot(later, name))) << name;
}

TEST(Spawn, RefusesWhatCannotBeAndChangesNothing) {
  Simulation simulation(room(), {perfect("r1", {})}, 1);
  EXPECT_EQ(refusal([&] { simulation.spawn(perfect("r1", {2.0, 0.0, 0.0})); }), "two robots have the name r1");
  EXPECT_EQ(refusal([&] { simulation.spawn(perfect("", {2.0, 0.0, 0.0})); }), "a robot needs a name");
  EXPECT_EQ(refusal([&] { simulation.spawn(perfect("r2", {0.3, 0.0, 0.0})); }), "robot r2 starts in or against r1");
  EXPECT_EQ(refusal([&] {
              simulation.spawn(perfect("r2", {9.1, 0.0, 0.0}));
            }),
            "robot r2 starts in or against an obstacle");
  EXPECT_EQ(refusal([&] {
              simulation.spawn(perfect("r2", {std::nan(""), 0.0, 0.0}));
            }),
            "robot r2: its pose must be finite");
  EXPECT_THROW(simulation.spawn(perfect("r2", {0.3, 0.0, 0.0})), NoRoom);
  EXPECT_EQ(simulation.robots().size(), 1u);
  simulation.spawn(perfect("r2", {2.0, 0.0, 0.0}));
  simulation.step(tick);
}

TEST(Spawn, TenThousandRobotsInACupboardAreRefusedAtTheFirstThatDoesNotFit) {
  const auto cupboard = std::make_shared<const World>(Obstacles{
      .segments = {
          {{0.0, 0.0}, {2.0, 0.0}}, {{2.0, 0.0}, {2.0, 1.0}}, {{2.0, 1.0}, {0.0, 1.0}}, {{0.0, 1.0}, {0.0, 0.0}}}});
  std::vector<RobotSetup> robots;
  for (int i = 0; i < 10000; ++i) robots.push_back(perfect("r" + std::to_string(i), {0.4 + 0.6 * (i % 3), 0.5, 0.0}));
  EXPECT_EQ(refusal([&] { Simulation(cupboard, robots, 1); }), "robot r3 starts in or against r0");
}

TEST(Remove, TheOthersGoOnAsIfItHadBeenTheirsAloneOrBefore) {
  // r3 is out of everybody's sight; where it stands in the list before it goes must not matter.
  const RobotSetup r1 = noisy("r1", {0.0, 0.0, 0.6}), r2 = noisy("r2", {1.5, 0.0, 2.0}),
                   r3 = noisy("r3", {7.0, 0.0, 0.0});
  const auto run = [&](std::vector<RobotSetup> setups) {
    Simulation simulation(room(), std::move(setups), 1);
    for (int i = 0; i < 200; ++i) {
      if (i == 100 && simulation.find("r3")) simulation.remove("r3");
      command(simulation, "r1", {0.2, 0.1});
      command(simulation, "r2", {0.1, -0.2});
      simulation.step(tick);
    }
    return std::pair(state(robot(simulation, "r1")), state(robot(simulation, "r2")));
  };
  const auto first = run({r3, r1, r2});
  EXPECT_EQ(run({r1, r3, r2}), first);
  EXPECT_EQ(run({r2, r1, r3}), first);
}

TEST(Remove, ItsPlaceIsFreeAndItsNameToo) {
  Simulation simulation(room(), {perfect("r1", {}), perfect("r2", {0.7, 0.0, 0.0})}, 1);
  for (int i = 0; i < 300; ++i) {
    command(simulation, "r1", {0.5, 0.0});
    simulation.step(tick);
  }
  ASSERT_TRUE(robot(simulation, "r1").body().touching());
  simulation.remove("r2");
  EXPECT_FALSE(simulation.find("r2"));
  EXPECT_EQ(simulation.robots().size(), 1u);
  for (int i = 0; i < 200; ++i) {
    command(simulation, "r1", {0.5, 0.0});
    simulation.step(tick);
  }
  EXPECT_FALSE(robot(simulation, "r1").body().touching());
  EXPECT_GT(robot(simulation, "r1").pose().x, 0.7);
  simulation.spawn(perfect("r2", {}));
  EXPECT_EQ(refusal([&] { simulation.remove("r9"); }), "there is no robot r9");
}

TEST(Remove, WhoeverWasTouchedByItIsFreeEvenIfItNeverMoves) {
  Simulation simulation(room(), {perfect("r1", {}), perfect("r2", {0.7, 0.0, 0.0})}, 1);
  for (int i = 0; i < 300; ++i) {
    command(simulation, "r1", {0.5, 0.0});
    simulation.step(tick);
  }
  ASSERT_TRUE(robot(simulation, "r2").body().touching());
  simulation.remove("r1");
  simulation.step(tick);
  EXPECT_FALSE(robot(simulation, "r2").body().touching());
}

TEST(Teleport, TheTruthJumpsTheOdometryDoesNotAndTheRobotStands) {
  Simulation simulation(room(), {perfect("r1", {})}, 1);
  for (int i = 0; i < 200; ++i) {
    command(simulation, "r1", {0.5, 0.0});
    simulation.step(tick);
  }
  const Pose2 believed = robot(simulation, "r1").odometry().pose;
  simulation.teleport("r1", {3.0, 2.0, 1.5});
  EXPECT_EQ(robot(simulation, "r1").pose(), (Pose2{3.0, 2.0, 1.5}));
  EXPECT_EQ(robot(simulation, "r1").speed(), Twist2{});
  EXPECT_EQ(robot(simulation, "r1").odometry().pose, believed);
  for (int i = 0; i < 100; ++i) {
    command(simulation, "r1", {0.2, 0.0});
    simulation.step(tick);
  }
  const Pose2 &truth = robot(simulation, "r1").pose(), &odometry = robot(simulation, "r1").odometry().pose;
  const double driven = (truth.position() - Vector2(3.0, 2.0)).norm();
  EXPECT_GT(driven, 0.1);
  EXPECT_NEAR(odometry.x - believed.x, driven, 1e-9) << "straight on along its own x axis, as its wheels say";
  EXPECT_NEAR(odometry.y - believed.y, 0.0, 1e-9);
}

TEST(Teleport, OthersSeeItWhereItIsNow) {
  Simulation simulation(room(), {perfect("r1", {}), perfect("r2", {4.0, 0.0, 0.0})}, 1);
  simulation.teleport("r2", {1.0, 0.0, 0.0});
  for (int i = 0; i < 10; ++i) simulation.step(tick);
  EXPECT_LT(robot(simulation, "r1").sonar().ranges[3], 1.0);
}

TEST(Teleport, EndsATouch) {
  Simulation simulation(room(), {perfect("r1", {8.0, 0.0, 0.0})}, 1);
  for (int i = 0; i < 300; ++i) {
    command(simulation, "r1", {0.5, 0.0});
    simulation.step(tick);
  }
  ASSERT_TRUE(robot(simulation, "r1").body().touching());
  simulation.teleport("r1", {});
  EXPECT_FALSE(robot(simulation, "r1").body().touching());
  EXPECT_EQ(robot(simulation, "r1").body().contacts(), 1u);
}

TEST(Teleport, RefusesAPlaceWithoutRoomAndChangesNothing) {
  Simulation simulation(room(), {perfect("r1", {}), perfect("r2", {2.0, 0.0, 0.0})}, 1);
  EXPECT_EQ(refusal([&] { simulation.teleport("r2", {0.3, 0.0, 0.0}); }), "robot r2 would stand in or against r1");
  EXPECT_EQ(refusal([&] {
              simulation.teleport("r2", {0.0, 5.0, 0.0});
            }),
            "robot r2 would stand in or against an obstacle");
  EXPECT_EQ(refusal([&] {
              simulation.teleport("r2", {0.0, std::numeric_limits<double>::infinity(), 0.0});
            }),
            "robot r2: its pose must be finite");
  EXPECT_EQ(refusal([&] { simulation.teleport("r3", {}); }), "there is no robot r3");
  EXPECT_THROW(simulation.teleport("r2", {0.3, 0.0, 0.0}), NoRoom);
  EXPECT_EQ(robot(simulation, "r2").pose(), (Pose2{2.0, 0.0, 0.0}));
  simulation.teleport("r2", {2.1, 0.0, 0.0});
  EXPECT_EQ(robot(simulation, "r2").pose(), (Pose2{2.1, 0.0, 0.0})) << "its own body is not in its way";
}

TEST(Reset, ANewSimulationOfTheSameSetupsGoesTheSameWay) {
  const auto world = room();
  const std::vector<RobotSetup> setups{noisy("r1", {0.0, 0.0, 0.6}), noisy("r2", {1.5, 0.0, 2.0})};
  Simulation simulation(world, setups, 7);
  const auto run = [&simulation] {
    for (int i = 0; i < 100; ++i) {
      command(simulation, "r1", {0.3, 0.1});
      simulation.step(tick);
    }
    return state(robot(simulation, "r1"));
  };
  const auto first = run();
  simulation = Simulation(world, setups, 7);
  EXPECT_EQ(simulation.now(), 0ms);
  EXPECT_EQ(run(), first);
}

}  // namespace
}  // namespace kervan::sim
