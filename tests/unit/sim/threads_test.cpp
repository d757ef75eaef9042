// A step on several threads, with bodies sorted into cells, is the step that the rules describe: one robot after the
// other, everybody asked.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "framework/workers/worker_pool.hpp"
#include "sim/simulation.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

constexpr int columns = 6, rows = 5;
constexpr double spacing = 0.8;

/// Robots so close together that they meet again and again, in a pen with a pillar.
std::vector<RobotSetup> crowd() {
  std::vector<RobotSetup> setups;
  for (int i = 0; i < columns * rows; ++i) {
    RobotSetup setup = perfect("r" + std::to_string(i), {spacing * (i % columns), spacing * (i / columns), 0.7 * i});
    if (i == 7 || i == 20) setup.model = load_robot_model(KERVAN_SIM_FOLDER "/robots/k2a.yaml");
    setup.sonar = {.rays = 3, .noise = 0.01, .drop_out = 0.01};
    setup.model.laser = LaserMount{.pose = {0.1, 0.0, 0.0}, .beams = 31, .field_of_view = pi, .max_range = 4.0};
    setup.odometry.drift = 0.02;
    setup.model.drive.acceleration = 2.0;
    if (i == 7 || i == 8 || i == 20) setup = with_everything(std::move(setup));
    setups.push_back(std::move(setup));
  }
  return setups;
}

std::shared_ptr<const World> pen() {
  const double right = spacing * columns, top = spacing * rows;
  return std::make_shared<const World>(Obstacles{.segments = {{{-1.5, -0.6}, {right, -0.6}},
                                                              {{right, -0.6}, {right, top}},
                                                              {{right, top}, {-1.5, top}},
                                                              {{-1.5, top}, {-1.5, -0.6}}},
                                                 .circles = {{{-1.0, 2.0}, 0.1}}});
}

Twist2 wish(std::size_t robot, int step) {
  const RandomSource random(5, "wishes");
  auto sequence = random.at(RandomUse::sonar, static_cast<std::uint16_t>(robot), static_cast<std::uint64_t>(step / 7));
  return {sequence.uniform(-0.5, 1.0), sequence.uniform(-1.5, 1.5)};
}

void note(const Robot& robot, std::vector<double>& history) {
  const Contact& contact = robot.body().last_contact();
  history.insert(history.end(),
                 {robot.pose().x, robot.pose().y, robot.pose().yaw, robot.speed().linear, robot.body().min_clearance(),
                  static_cast<double>(robot.body().contacts()), robot.body().touching() ? 1.0 : 0.0, contact.point.x(),
                  contact.point.y(), robot.odometry().pose.x});
  history.insert(history.end(), {robot.gyro().rate, robot.odometry().pose.yaw, robot.stall().left ? 1.0 : 0.0,
                                 robot.stall().right ? 1.0 : 0.0});
  history.insert(history.end(), robot.pressed().begin(), robot.pressed().end());
  history.push_back(contact.other.empty() ? -1.0 : std::stod(contact.other.substr(1)));
  // Histories are compared as numbers, and no NaN is equal to another.
  for (const double range : robot.sonar().ranges) history.push_back(std::isnan(range) ? -1.0 : range);
  history.insert(history.end(), robot.laser().ranges.begin(), robot.laser().ranges.end());
}

std::vector<double> history(Duration dt, int steps, int threads) {
  Simulation simulation(pen(), crowd(), 1, threads);
  std::vector<double> numbers;
  for (int step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < simulation.robots().size(); ++i) simulation.command(i, wish(i, step));
    simulation.step(dt);
    for (const Robot& robot : simulation.robots()) note(robot, numbers);
  }
  return numbers;
}

/// The rules, word by word.
std::vector<double> history_by_the_rules(Duration dt, int steps) {
  const auto world = pen();
  std::vector<Robot> robots;
  Bodies bodies;  // never sorted, so each is asked
  for (const RobotSetup& setup : crowd()) {
    robots.emplace_back(setup, 1, Surroundings(*world, bodies, bodies.size()));
    bodies.add(setup.name, setup.model.outline, setup.start);
  }
  std::vector<std::size_t> order(robots.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return robots[a].name() < robots[b].name(); });
  for (std::size_t i = 0; i < robots.size(); ++i) robots[i].measure_first(Surroundings(*world, bodies, i), 0ms);

  std::vector<double> numbers;
  for (int step = 0; step < steps; ++step) {
    const Duration now = step * dt;
    for (std::size_t i = 0; i < robots.size(); ++i) robots[i].command(wish(i, step), now);
    for (const std::size_t i : order) {
      const auto contacts = robots[i].body().contacts();
      robots[i].plan(now, dt);
      robots[i].drive(Surroundings(*world, bodies, i));
      bodies.move(i, robots[i].body().hull());
      if (robots[i].body().contacts() == contacts) continue;
      const Contact& contact = robots[i].body().last_contact();
      for (Robot& other : robots)
        if (other.name() == contact.other) other.touched_by(robots[i].name(), contact.point);
    }
    for (std::size_t i = 0; i < robots.size(); ++i) robots[i].measure(Surroundings(*world, bodies, i), now, now + dt);
    for (const Robot& robot : robots) note(robot, numbers);
  }
  return numbers;
}

TEST(Threads, AStepIsWhatTheRulesSayOnAnyNumberOfThreads) {
  for (const auto& [dt, steps] : {std::pair{Duration(10ms), 80}, {Duration(100ms), 30}}) {
    const std::vector<double> expected = history_by_the_rules(dt, steps);
    for (const int threads : {1, 2, 5}) {
      const std::vector<double> found = history(dt, steps, threads);
      ASSERT_EQ(found.size(), expected.size());
      const auto different = std::mismatch(found.begin(), found.end(), expected.begin());
      EXPECT_TRUE(different.first == found.end())
          << threads << " threads, steps of " << seconds(dt) << " s: number " << different.first - found.begin();
    }
  }
}

TEST(Threads, TheCrowdOfTheseTestsDoesMeet) {
  Simulation simulation(pen(), crowd(), 1);
  std::size_t others = 0;
  for (int step = 0; step < 30; ++step) {
    for (std::size_t i = 0; i < simulation.robots().size(); ++i) simulation.command(i, wish(i, step));
    simulation.step(100ms);
  }
  for (const Robot& robot : simulation.robots()) others += robot.body().last_contact().other.size() > 0 ? 1 : 0;
  EXPECT_GT(others, simulation.robots().size() / 3);
}

TEST(Threads, LongRobotsThatTurnOnTheSpotDoNotTurnIntoEachOther) {
  const auto nothing = std::make_shared<const World>(Obstacles{});
  const Outline bar({{0.6, -0.1}, {0.6, 0.1}, {-0.6, 0.1}, {-0.6, -0.1}});
  for (const auto& [a, b, distance] : {std::array{0.70, 1.59, 1.136}, {3.85, 4.69, 1.14}, {1.14, 0.88, 1.183}}) {
    // Those who were all but touched once heed nobody who stays farther away than a millimetre.
    std::vector<RobotSetup> setups{perfect("a", {0.0, 0.0, a}), perfect("b", {5.0, 0.0, 0.0}),
                                   perfect("c", Pose2{0.0, 0.0, a} * Pose2{0.9001, 0.0, 0.0}),
                                   perfect("d", {5.9001, 0.0, 0.0})};
    for (RobotSetup& setup : setups) setup.model.drive.angular_acceleration = 100.0;
    for (std::size_t i : {0u, 1u}) setups[i].model.outline = bar;
    Simulation simulation(nothing, setups, 1);
    simulation.teleport("c", {20.0, 0.0, 0.0});
    simulation.teleport("b", {0.0, distance, b});
    simulation.command(0, {0.0, 1.72});
    simulation.command(1, {0.0, 1.72});
    simulation.step(240ms);
    Bodies other;
    other.add("b", bar, simulation.robots()[1].pose());
    EXPECT_GT(clearance(other, 0, bar, simulation.robots()[0].pose()).distance, 0.0) << distance << " m apart";
    EXPECT_EQ(simulation.robots()[1].body().contacts(), 1u) << distance << " m apart";
  }
}

TEST(Threads, LongRobotsThatPassEachOtherCloselyHeedEachOther) {
  // Side by side, five centimetres apart. The first goes two centimetres ahead, and the line through their centres
  // turns so far that along it they overlap. Then the second moves in small parts, which are rounded one by one.
  const auto nothing = std::make_shared<const World>(Obstacles{});
  const Outline bar({{0.6, -0.1}, {0.6, 0.1}, {-0.6, 0.1}, {-0.6, -0.1}});
  const Pose2 first{0.3, 0.2, 0.7}, second = first * Pose2{0.0, 0.25, 0.0};
  // As above, they are all but touched once, so that they heed nobody farther away than a millimetre.
  std::vector<RobotSetup> setups{perfect("a", {10.0, 0.0, 0.0}), perfect("b", {20.0, 0.0, 0.0}),
                                 perfect("c", {10.9001, 0.0, 0.0}), perfect("d", {20.9001, 0.0, 0.0})};
  for (RobotSetup& setup : setups) setup.model.drive.acceleration = setup.model.drive.angular_acceleration = 100.0;
  for (std::size_t i : {0u, 1u}) setups[i].model.outline = bar;
  Simulation simulation(nothing, setups, 1);
  simulation.teleport("a", first);
  simulation.teleport("b", second);
  std::vector<Robot> robots{simulation.robots().begin(), simulation.robots().begin() + 2};
  simulation.command(0, {1.0, 0.0});
  simulation.command(1, {0.7, 0.3});
  simulation.step(20ms);

  Bodies bodies;
  for (const Robot& robot : robots) bodies.add(robot.name(), bar, robot.pose());
  robots[0].command({1.0, 0.0}, 0ms);
  robots[1].command({0.7, 0.3}, 0ms);
  for (std::size_t i : {0u, 1u}) {
    robots[i].plan(0ms, 20ms);
    robots[i].drive(Surroundings(*nothing, bodies, i));
    bodies.move(i, robots[i].pose());
  }
  for (std::size_t i : {0u, 1u}) {
    EXPECT_EQ(simulation.robots()[i].pose().x, robots[i].pose().x);
    EXPECT_EQ(simulation.robots()[i].pose().y, robots[i].pose().y);
    EXPECT_EQ(simulation.robots()[i].pose().yaw, robots[i].pose().yaw);
  }
}

TEST(Workers, DoEveryPieceOfWorkOnce) {
  for (const int threads : {1, 2, 4}) {
    workers::WorkerPool pool(threads);
    for (const std::size_t count : {0u, 1u, 17u, 1000u})
      for (int round = 0; round < 20; ++round) {
        std::vector<std::atomic<int>> done(count);
        pool.for_each(count, 2, [&](std::size_t i) { ++done[i]; });
        EXPECT_TRUE(std::all_of(done.begin(), done.end(), [](const auto& times) { return times == 1; }));
      }
  }
}

}  // namespace
}  // namespace kervan::sim
