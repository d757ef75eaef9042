// Robots among each other: they see each other's bodies, and none drives through another.
#include <gtest/gtest.h>

#include "sim/simulation.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

constexpr double nose = 0.211, tail = 0.300;  // m from base_link of a P3-DX

std::shared_ptr<const World> nothing() { return std::make_shared<const World>(Obstacles{}); }

/// Commands all robots alike and moves on.
void drive(Simulation& simulation, const std::vector<Twist2>& wanted, Duration time) {
  for (const Duration end = simulation.now() + time; simulation.now() < end;) {
    for (std::size_t i = 0; i < wanted.size(); ++i) simulation.command(i, wanted[i]);
    simulation.step(tick);
  }
}

double gap(const Robot& a, const Robot& b) {
  Bodies bodies;
  bodies.add(b.name(), b.body().outline(), b.pose());
  return clearance(bodies, 0, a.body().outline(), a.pose()).distance;
}

double gap(const Simulation& simulation) { return gap(simulation.robots()[0], simulation.robots()[1]); }

TEST(Robots, HearTheEchoOfEachOthersBodies) {
  RobotSetup setup = perfect("r1", {0.0, 0.0, 0.0});
  setup.sonar.rays = 1;
  Simulation simulation(nothing(), {setup, perfect("r2", {1.0, 0.0, 0.0})}, 1);
  // Transducer 3 stands at (0.166, 0.027) and looks 10 degrees to the left: it meets the corner that is cut off.
  const Vector2 transducer(0.166, 0.027), looks = geometry::heading(10.0 * std::numbers::pi / 180.0);
  const double slanted = simulation.robots()[0].sonar().ranges[3];
  const Vector2 echo = transducer + slanted * looks;
  EXPECT_NEAR((echo.x() - (1.0 - tail)) - (echo.y() - 0.110), 0.0, 1e-9) << "on the line x - y of that corner";
  EXPECT_EQ(simulation.robots()[0].sonar().ranges[0], infinity) << "nobody stands to the left";
  EXPECT_EQ(simulation.robots()[1].sonar().ranges[3], infinity) << "nobody stands before the other";
  EXPECT_NEAR(simulation.robots()[1].sonar().ranges[11], 1.0 - 0.255 - nose, 0.03) << "but behind it";
}

TEST(Robots, SeeEachOtherWhereTheyAreAfterTheStep) {
  RobotSetup still = perfect("r1", {0.0, 0.0, 0.0});
  still.sonar_period = tick;
  Simulation simulation(nothing(), {still, perfect("r2", {2.0, 0.0, 0.0})}, 1);
  double before = simulation.robots()[0].sonar().ranges[3];
  for (int i = 0; i < 100; ++i) {
    simulation.command(1, {0.5, 0.0});
    const double x = simulation.robots()[1].pose().x;
    simulation.step(tick);
    const double now = simulation.robots()[0].sonar().ranges[3];
    EXPECT_NEAR(now - before, simulation.robots()[1].pose().x - x, 0.2 * (simulation.robots()[1].pose().x - x) + 1e-12);
    before = now;
  }
}

TEST(Robots, AWallBetweenThemHidesThem) {
  const auto wall = std::make_shared<const World>(Obstacles{.segments = {{{1.0, -3.0}, {1.0, 3.0}}}});
  const RobotSetup r1 = perfect("r1", {0.0, 0.0, 0.0}), r2 = perfect("r2", {2.0, 0.0, 0.0});
  EXPECT_EQ(Simulation(wall, {r1, r2}, 1).robots()[0].sonar().ranges,
            Simulation(wall, {r1}, 1).robots()[0].sonar().ranges);
}

TEST(Robots, OneThatDrivesIntoAnotherIsStoppedAndBothAreTouched) {
  Simulation simulation(nothing(), {perfect("r1", {0.0, 0.0, 0.0}), perfect("r2", {2.0, 0.0, 0.0})}, 1);
  drive(simulation, {{0.5, 0.0}}, 8s);
  const Robot &r1 = simulation.robots()[0], &r2 = simulation.robots()[1];
  EXPECT_EQ(r1.body().contacts(), 1u);
  EXPECT_EQ(r1.body().last_contact().other, "r2");
  EXPECT_EQ(r2.body().contacts(), 1u);
  EXPECT_EQ(r2.body().last_contact().other, "r1");
  EXPECT_NEAR(r1.body().last_contact().point.x(), 2.0 - tail, 1e-5);
  EXPECT_EQ(r2.pose(), (Pose2{2.0, 0.0, 0.0})) << "it is not pushed";
  EXPECT_NEAR(r1.pose().x, 2.0 - tail - nose, 1e-5);
  EXPECT_GT(gap(simulation), 0.0);
  EXPECT_EQ(r1.speed().linear, 0.0);
  EXPECT_LT(r2.body().min_clearance(), 1e-5) << "although it never moved";

  drive(simulation, {{-0.3, 0.0}}, 2s);
  EXPECT_FALSE(r1.body().touching());
  EXPECT_FALSE(r2.body().touching());
  drive(simulation, {{0.3, 0.0}}, 6s);
  EXPECT_EQ(r1.body().contacts(), 2u);
  EXPECT_EQ(r2.body().contacts(), 2u);
}

TEST(Robots, WhoDriveIntoEachOtherTouchOnce) {
  Simulation simulation(nothing(), {perfect("r1", {0.0, 0.0, 0.0}), perfect("r2", {2.0, 0.0, pi})}, 1);
  drive(simulation, {{0.5, 0.0}, {0.5, 0.0}}, 8s);
  for (const Robot& robot : simulation.robots()) {
    EXPECT_TRUE(robot.body().touching());
    EXPECT_EQ(robot.body().contacts(), 1u) << robot.name();
  }
}

TEST(Robots, TheOneThatWasHitDrivesAwayFreely) {
  Simulation simulation(nothing(), {perfect("r1", {0.0, 0.0, 0.0}), perfect("r2", {0.7, 0.0, 0.0})}, 1);
  drive(simulation, {{0.5, 0.0}}, 3s);
  ASSERT_TRUE(simulation.robots()[1].body().touching());
  drive(simulation, {{0.0, 0.0}, {0.3, 0.0}}, 2s);
  EXPECT_GT(simulation.robots()[1].pose().x, 0.9);
  EXPECT_FALSE(simulation.robots()[0].body().touching());
}

TEST(Robots, NeverOverlapWhateverTheyDo) {
  const RandomSource random(7, "robots");
  std::vector<RobotSetup> setups;
  for (int i = 0; i < 6; ++i)
    setups.push_back(perfect("r" + std::to_string(i), {0.8 * (i % 3), 0.8 * (i / 3), 0.9 * i}));
  const auto pen = std::make_shared<const World>(Obstacles{.segments = {{{-0.6, -0.6}, {2.4, -0.6}},
                                                                        {{2.4, -0.6}, {2.4, 1.6}},
                                                                        {{2.4, 1.6}, {-0.6, 1.6}},
                                                                        {{-0.6, 1.6}, {-0.6, -0.6}}}});
  Simulation simulation(pen, setups, 1);
  std::uint64_t contacts = 0;
  for (std::uint64_t round = 0; round < 60; ++round) {
    std::vector<Twist2> wanted;
    for (std::uint16_t i = 0; i < 6; ++i) {
      auto sequence = random.at(RandomUse::sonar, i, round);
      wanted.push_back({2.0 * sequence.uniform() - 1.0, 3.0 * sequence.uniform() - 1.5});
    }
    drive(simulation, wanted, 500ms);
    for (std::size_t a = 0; a < 6; ++a)
      for (std::size_t b = 0; b < a; ++b) {
        ASSERT_GT(gap(simulation.robots()[a], simulation.robots()[b]), 0.0) << "round " << round;
      }
  }
  for (const Robot& robot : simulation.robots()) contacts += robot.body().contacts();
  EXPECT_GT(contacts, 20u) << "they were not just lucky";
}

TEST(Robots, TheirOrderInTheListDoesNotMatterWhenTheyMeet) {
  const RobotSetup a = perfect("a", {0.0, 0.0, 0.0}), b = perfect("b", {1.5, 0.1, 3.0}),
                   c = perfect("c", {0.7, 0.9, -1.5});
  const auto meet = [](std::vector<RobotSetup> setups) {
    Simulation simulation(nothing(), setups, 1);
    drive(simulation, std::vector<Twist2>(3, {0.4, 0.1}), 5s);
    std::map<std::string, std::vector<double>> end;
    for (const Robot& robot : simulation.robots()) {
      end[robot.name()] = {robot.pose().x, robot.pose().y, robot.pose().yaw, robot.body().min_clearance(),
                           static_cast<double>(robot.body().contacts())};
      end[robot.name()].insert(end[robot.name()].end(), robot.sonar().ranges.begin(), robot.sonar().ranges.end());
    }
    return end;
  };
  const auto end = meet({a, b, c});
  EXPECT_EQ(meet({c, a, b}), end);
  EXPECT_EQ(meet({b, c, a}), end);
  EXPECT_GT(end.at("a")[4] + end.at("b")[4] + end.at("c")[4], 0.0) << "they did meet";
}

}  // namespace
}  // namespace kervan::sim
