/// How fast the simulator is: robots that wander through a cave with sonars, lasers or both, from one of them to a
/// thousand; how the cost grows with their number; what a second thread brings; what publishing costs.
#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "framework/test/harness.hpp"
#include "sim/files/robot_file.hpp"
#include "sim/files/world_file.hpp"
#include "sim/simulation.hpp"
#include "tests/bench/maps.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/statistics.hpp"

namespace {

using namespace kervan;
using namespace std::chrono_literals;
using bench::median;
using bench::say;
using sim::Simulation;
using sim::Vector2;

enum class Sensors { sonar, laser, both };
constexpr std::array<Sensors, 3> all_sensors{Sensors::sonar, Sensors::laser, Sensors::both};
const char* text(Sensors sensors) {
  return sensors == Sensors::sonar ? "sonar" : sensors == Sensors::laser ? "laser" : "both";
}

double cpu_seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
/// Of this thread alone, so that others on the machine do not count.
double thread_seconds() { return cpu_seconds(CLOCK_THREAD_CPUTIME_ID); }
double wall_seconds() { return 1e-9 * static_cast<double>(bench::now_ns()); }

/// A P3-DX with 16 sonars of one ray each, the laser of Stage's harness, or both, at 10 Hz; imperfect as usual.
sim::RobotSetup setup(std::size_t number, const sim::Pose2& start, Sensors sensors) {
  static const sim::RobotModel p3dx = sim::load_robot_model(KERVAN_SOURCES "/sim/robots/p3dx.yaml");
  sim::RobotSetup setup{.name = "r" + std::to_string(number), .model = p3dx, .start = start};
  setup.sonar.rays = 1;
  setup.odometry_period = 100ms;
  if (sensors == Sensors::laser) setup.model.sonars = {};
  if (sensors != Sensors::sonar)
    setup.model.laser = sim::LaserMount{
        .pose = {0.018, 0.0, 0.0}, .beams = 181, .field_of_view = std::numbers::pi, .min_range = 0.0, .max_range = 8.0};
  return setup;
}

/// Robots at random free places between (0, 0) and (extent, extent).
Simulation crowd(const std::shared_ptr<const sim::World>& world, double extent, std::size_t count, Sensors sensors,
                 int threads = 1) {
  Simulation simulation(world, {}, 1, threads);
  std::mt19937 random(1);
  const auto number = [&random](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  for (std::size_t i = 0; i < count;) {
    try {
      simulation.spawn(setup(i, {number(0.0, extent), number(0.0, extent), number(-3.0, 3.0)}, sensors));
      ++i;
    } catch (const sim::NoRoom&) {
    }
  }
  return simulation;
}

/// Drives on where it is free, turns to one side where it is not, and backs out where it has bumped into something.
void wander(Simulation& simulation) {
  for (std::size_t i = 0; i < simulation.robots().size(); ++i) {
    const sim::Robot& robot = simulation.robots()[i];
    double ahead = sim::infinity;
    if (!robot.laser().ranges.empty())
      for (std::size_t beam = 60; beam <= 120; beam += 5) ahead = std::min(ahead, robot.laser().ranges[beam]);
    else
      for (std::size_t sonar = 1; sonar <= 6; ++sonar) ahead = std::min(ahead, robot.sonar().ranges[sonar]);
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    if (robot.body().touching())
      simulation.command(i, {-0.2, -side});
    else
      simulation.command(i, ahead > 0.6 ? geometry::Twist2{0.4, 0.0} : geometry::Twist2{0.0, side});
  }
}

void run(Simulation& simulation, Duration step, Duration time) {
  for (const Duration end = simulation.now() + time; simulation.now() < end; simulation.step(step)) wander(simulation);
}

/// Simulated seconds that one second of `clock` brings; runs for at least `seconds` of it.
double rate(Simulation& simulation, Duration step, double seconds, double (*clock)()) {
  const Duration begin = simulation.now();
  const double start = clock();
  double used = 0.0;
  do run(simulation, step, 10 * step);
  while ((used = clock() - start) < seconds);
  return sim::seconds(simulation.now() - begin) / used;
}

constexpr Duration settle = 2s;  // the first steps are not those of a run

void bench_speed(bool smoke) {
  const auto small = std::make_shared<const sim::World>(sim::Obstacles{.bitmaps = {bench::cave(16.0)}});
  const auto large = std::make_shared<const sim::World>(sim::Obstacles{.bitmaps = {bench::cave(64.0)}});
  say("\n## Speed, one thread\n\nSimulated seconds for each second of the thread; median of %d runs. The least is for "
      "steps as\nlong as the sensors' period, as Stage's.\n\n"
      "| world | robots | sensors | step | speed | least | microseconds for each robot and simulated second |\n"
      "|---|---|---|---|---|---|---|\n",
      smoke ? 1 : 3);
  struct Bar {
    std::size_t robots;
    Sensors sensors;
    double speed;
  };
  const std::array<Bar, 6> bars{{{1, Sensors::sonar, 20000.0},
                                 {100, Sensors::sonar, 270.0},
                                 {100, Sensors::laser, 30.0},
                                 {1000, Sensors::sonar, 15.0},
                                 {1000, Sensors::laser, 1.7},
                                 {1000, Sensors::both, 1.0}}};
  for (const std::size_t robots : {1u, 10u, 100u, 1000u})
    for (const Sensors sensors : all_sensors)
      for (const Duration step : {Duration(100ms), Duration(10ms)}) {
        if (smoke && robots > 10) continue;
        const bool big = robots > 100;
        std::vector<double> speeds;
        Simulation simulation = crowd(big ? large : small, big ? 64.0 : 16.0, robots, sensors);
        run(simulation, step, smoke ? step : settle);
        for (int round = 0; round < (smoke ? 1 : 3); ++round)
          speeds.push_back(rate(simulation, step, smoke ? 0.0 : 0.7, thread_seconds));
        std::string least = "-";
        for (const Bar& bar : bars)
          if (step == 100ms && bar.robots == robots && bar.sensors == sensors)
            least = std::to_string(bar.speed).substr(0, 5);
        while (least.size() > 1 && (least.back() == '0' || least.back() == '.') && least.find('.') != std::string::npos)
          least.pop_back();
        say("| %s, %s | %zu | %s | %.0f ms | %.4g | %s | %.1f |\n", bench::cave_name().c_str(),
            big ? "64 x 64 m" : "16 x 16 m", robots, text(sensors), 1e3 * sim::seconds(step), median(speeds),
            least.c_str(), 1e6 / median(speeds) / static_cast<double>(robots));
      }
}

/// The same room again and again, so that every robot has as much around it in a large world as in a small one: walls
/// around 6.3 x 6.3 m, discs in it, on a raster of 10 cm cells.
constexpr int room_cells = 63, robots_a_room = 10;

sim::Bitmap rooms(int columns, int rows) {
  const int width = columns * room_cells, height = rows * room_cells;
  sim::Bitmap map{
      {}, Vector2::Constant(0.1), width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width * height))};
  std::vector<std::array<int, 3>> discs(4);
  std::mt19937 random(1);
  for (auto& disc : discs)
    disc = {static_cast<int>(random() % room_cells), static_cast<int>(random() % room_cells),
            2 + static_cast<int>(random() % 6u)};
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const int x = column % room_cells, y = row % room_cells;
      bool solid = x == 0 || y == 0 || x == room_cells - 1 || y == room_cells - 1;
      for (const auto& [center_x, center_y, radius] : discs)
        solid |= (x - center_x) * (x - center_x) + (y - center_y) * (y - center_y) < radius * radius;
      map.solid[static_cast<std::size_t>(row * width + column)] = solid;
    }
  return map;
}

/// The same ten robots in every room; they measure with noise of their own, so they do not stay alike.
Simulation crowd_in_rooms(int columns, int rows) {
  std::mt19937 random(1);
  const auto number = [&random](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  const double side = 0.1 * room_cells;
  Simulation one(std::make_shared<const sim::World>(sim::Obstacles{.bitmaps = {rooms(1, 1)}}), {}, 1);
  while (one.robots().size() < robots_a_room) {
    try {
      one.spawn(setup(one.robots().size(), {number(0.0, side), number(0.0, side), number(-3.0, 3.0)}, Sensors::both));
    } catch (const sim::NoRoom&) {
    }
  }
  Simulation all(std::make_shared<const sim::World>(sim::Obstacles{.bitmaps = {rooms(columns, rows)}}), {}, 1);
  for (int room = 0; room < columns * rows; ++room)
    for (const sim::Robot& robot : one.robots()) {
      sim::Pose2 start = robot.pose();
      start.x += side * (room % columns);
      start.y += side * (room / columns);
      all.spawn(setup(all.robots().size(), start, Sensors::both));
    }
  return all;
}

void bench_growth(bool smoke) {
  say("\n## Growth at the same density\n\nThe same room of %.1f x %.1f m again and again with ten robots in each, both "
      "sensors, steps of 100 ms, one thread; median of %d runs.\n\n| robots | rooms | microseconds for each robot and "
      "step | of that of 10 |\n|---|---|---|---|\n",
      0.1 * room_cells, 0.1 * room_cells, smoke ? 1 : 5);
  double first = 0.0;
  for (const auto& [columns, rows] : std::array<std::pair<int, int>, 4>{{{1, 1}, {5, 2}, {10, 10}, {40, 25}}}) {
    if (smoke && columns * rows > 10) continue;
    Simulation simulation = crowd_in_rooms(columns, rows);
    run(simulation, 100ms, smoke ? 100ms : settle);
    std::vector<double> speeds;
    for (int round = 0; round < (smoke ? 1 : 5); ++round)
      speeds.push_back(rate(simulation, 100ms, smoke ? 0.0 : 0.7, thread_seconds));
    const std::size_t robots = simulation.robots().size();
    const double cost = 1e5 / median(speeds) / static_cast<double>(robots);
    if (first == 0.0) first = cost;
    say("| %zu | %d | %.2f | %.2f |\n", robots, columns * rows, cost, cost / first);
  }
}

/// Everything the robots know, in one number.
double digest(const Simulation& simulation) {
  double sum = 0.0, factor = 1.0;
  for (const sim::Robot& robot : simulation.robots()) {
    for (const std::vector<double>* ranges : {&robot.sonar().ranges, &robot.laser().ranges})
      for (const double range : *ranges)
        if (std::isfinite(range)) sum += (factor += 1e-3) * range;
    sum += (factor += 1e-3) * (robot.pose().x + robot.pose().y + robot.pose().yaw + robot.odometry().pose.x);
  }
  return sum;
}

bool bench_threads(bool smoke) {
  say("\n## Two threads\n\n1000 robots in the cave of 64 x 64 m, wall time, medians of %d alternating rounds: two runs "
      "of "
      "one thread each at the same time, and one run of two threads.\n\n"
      "| sensors | step | one run alone | two runs of one thread, together | one run of two threads | share | least | "
      "equal to the last bit |\n|---|---|---|---|---|---|---|---|\n",
      smoke ? 1 : 5);
  const auto world = std::make_shared<const sim::World>(sim::Obstacles{.bitmaps = {bench::cave(64.0)}});
  const std::size_t robots = smoke ? 20 : 1000;
  const Duration time = smoke ? 200ms : 1s;
  bool equal = true;
  for (const Sensors sensors : all_sensors)
    for (const Duration step : {Duration(100ms), Duration(10ms)}) {
      if (smoke && step == 10ms) continue;
      const auto timed = [&](Simulation& simulation) {
        const double start = wall_seconds();
        run(simulation, step, time);
        return sim::seconds(time) / (wall_seconds() - start);
      };
      std::array<Simulation, 3> single{crowd(world, 64.0, robots, sensors), crowd(world, 64.0, robots, sensors),
                                       crowd(world, 64.0, robots, sensors)};
      Simulation threaded = crowd(world, 64.0, robots, sensors, 2);
      std::vector<double> alone, together, shared, share;
      for (int round = 0; round < (smoke ? 1 : 5); ++round) {
        alone.push_back(timed(single[0]));
        std::array<double, 2> rates{};
        std::thread other([&] { rates[1] = timed(single[2]); });
        rates[0] = timed(single[1]);
        other.join();
        together.push_back(rates[0] + rates[1]);
        shared.push_back(timed(threaded));
        share.push_back(shared.back() / together.back());
      }
      const bool same = digest(single[0]) == digest(threaded);
      equal = equal && same;
      say("| %s | %.0f ms | %.1f | %.1f | %.1f | %.0f %% | 85 %% | %s |\n", text(sensors), 1e3 * sim::seconds(step),
          median(alone), median(together), median(shared), 100.0 * median(share), same ? "yes" : "NO");
    }
  return equal;
}

double heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

void bench_memory() {
  say("\n## Memory\n\n| | bytes |\n|---|---|\n");
  double before = heap_bytes();
  const sim::Bitmap bitmap = bench::cave(64.0);
  const double picture = heap_bytes() - before;
  before = heap_bytes();
  const auto world = std::make_shared<const sim::World>(sim::Obstacles{.bitmaps = {bitmap}});
  say("| a cell of the cave, its share of the edges included (the picture itself had %.1f) | %.2f |\n",
      picture / (bitmap.columns * bitmap.rows), (heap_bytes() - before) / (bitmap.columns * bitmap.rows));
  for (const Sensors sensors : all_sensors)
    for (const int rays : {1, 32}) {
      if (sensors == Sensors::laser && rays > 1) continue;
      constexpr std::size_t count = 200;
      std::vector<sim::RobotSetup> setups;
      for (std::size_t i = 0; i < count; ++i) {
        setups.push_back(setup(i, {static_cast<double>(i), -10.0, 0.0}, sensors));
        setups.back().sonar.rays = rays;
      }
      before = heap_bytes();
      const Simulation simulation(world, setups, 1);
      say("| a robot, %s%s | %.0f |\n", text(sensors),
          sensors == Sensors::laser ? ""
          : rays == 1               ? ", one ray"
                                    : ", 32 rays",
          (heap_bytes() - before) / static_cast<double>(count));
    }
}

/// The component in logical time with a reader on every port, beside the library alone.
void bench_component(bool smoke) {
  constexpr int robots = 10;
  const std::string model = KERVAN_SOURCES "/sim/robots/p3at.yaml", map = KERVAN_SOURCES "/sim/worlds/hall.yaml";
  const Duration time = smoke ? 100ms : 20s;
  ValueMap named;
  std::vector<sim::RobotSetup> setups;
  for (int i = 0; i < robots; ++i) {
    const sim::Pose2 start{2.0 + 3.5 * (i % 5), i < 5 ? 4.0 : 7.0, 0.3 * i};
    const std::string name = "r" + std::to_string(i);
    named[name] = ValueMap{{"model", model}, {"start", ValueList{start.x, start.y, start.yaw}}};
    setups.push_back({.name = name, .model = sim::load_robot_model(model), .start = start});
  }
  std::vector<double> added;
  std::size_t messages = 0;
  for (int round = 0; round < (smoke ? 1 : 5); ++round) {
    Simulation simulation(std::make_shared<const sim::World>(sim::load_world(map)), setups, 1);
    test::Harness harness("sim/world", {{"map", map}, {"robots", named}});
    harness.advance(0ms);
    double start = thread_seconds();
    while (simulation.now() < time) simulation.step(10ms);
    const double library = thread_seconds() - start;
    start = thread_seconds();
    harness.advance(time);
    const double component = thread_seconds() - start;
    const auto steps = static_cast<std::size_t>(time / 10ms);
    // Each step the clock and a truth for each robot; at their periods odometry, /tf, sonars and laser.
    messages = steps * (1 + robots) + steps / 5 * (1 + robots) + steps / 10 * 2 * robots;
    added.push_back(1e6 * (component - library) / static_cast<double>(messages));
  }
  say("\n## The component sim/world\n\n10 robots with sonars and laser at steps of 10 ms, %zu messages, each handed to "
      "a "
      "reader in the same process: %.2f us more for each message than the library alone; at most 5.\n",
      messages, median(added));
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = bench::begin(argc, argv, "The simulator");
  double load = 0.0;
  getloadavg(&load, 1);
  say("\nP3-DX robots with 16 sonars of one ray (5 m), a laser of 181 beams (8 m), or both, at 10 Hz, with noise, that "
      "wander.\nAt the start the load average was %.1f.\n",
      load);
  bench_speed(smoke);
  bench_growth(smoke);
  const bool equal = bench_threads(smoke);
  bench_component(smoke);
  bench_memory();
  if (!equal) say("\nFAILED: two threads gave other results than one\n");
  return bench::end(!equal);
}
