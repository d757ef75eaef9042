// BARN: a robot drives ten metres through clutter that it does not know, in 150 worlds.
//
//   kervan_barn_experiment                        all robots, all worlds, 3 seeds
//   kervan_barn_experiment --smoke                one world, if there are any
//   kervan_barn_experiment --robot stack --world 12 --seeds 1 --trace --pictures FOLDER
//
// The worlds are those of data/barn (barn_world.hpp). The exit code is 1 if the stack does not succeed as often as is
// asked.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "components/observe/barn_score.hpp"
#include "sim/files/robot_file.hpp"
#include "tests/experiments/barn_robot.hpp"
#include "tests/experiments/barn_world.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using observe::BarnOutcome;

struct Contender {
  const char* name;
  const char* help;
  double drift = 0.0;
  BarnRobotParams params;
};

BarnRobotParams jackal(double v_max) {
  BarnRobotParams params;
  params.planner.costs = {.radius = 0.27, .clearance = 0.35, .clearance_cost = 6.0};
  params.dwa.v_max = v_max;
  params.dwa.turn_rate = 2.0;
  params.guard = {.period = 10ms,
                  .max_speed = 2.0,
                  .max_turn = 2.5,
                  .acceleration = 2.5,
                  .deceleration = 2.5,
                  .turn_acceleration = 6.0};
  params.monitor.emplace();
  return params;
}

std::vector<Contender> contenders() {
  std::vector<Contender> all{
      {.name = "dwa", .help = "control/dwa at 0.5 m/s, told only the goal", .params = jackal(0.5)},
      {.name = "baseline", .help = "planner and control/dwa at 0.5 m/s", .params = jackal(0.5)},
      {.name = "stack", .help = "our stack", .params = jackal(1.3)},
      {.name = "drifting", .help = "our stack, odometry with 1 % drift", .drift = 0.01, .params = jackal(1.3)},
  };
  all[0].params.plans = false;
  return all;
}

struct Options {
  std::vector<std::string> robots;
  std::vector<int> worlds;
  int seeds = 3, every = 1, offset = 0;
  bool trace = false, smoke = false;
  std::vector<std::string> set;
};

struct Result {
  int world, seed;
  BarnOutcome outcome;
  double time, metric, length, clearance;
};

std::map<std::string, double*> settings(BarnRobotParams& p) {
  auto& d = p.dwa;
  auto& c = p.planner.costs;
  return {{"v_max", &d.v_max},
          {"v_back", &d.v_back},
          {"turn_rate", &d.turn_rate},
          {"delay", &d.delay},
          {"window", &d.window},
          {"horizon", &d.horizon},
          {"margin", &d.margin},
          {"comfort", &d.comfort},
          {"near_cost", &d.near_cost},
          {"near_speed", &d.near_speed},
          {"haste_cost", &d.haste_cost},
          {"turn_cost", &d.turn_cost},
          {"change_cost", &d.change_cost},
          {"radius", &c.radius},
          {"clearance", &c.clearance},
          {"clearance_cost", &c.clearance_cost},
          {"look_ahead", &p.follow.look_ahead},
          {"cut", &p.follow.cut_corners},
          {"escape", &p.escape},
          {"detour", &d.detour_cost},
          {"ttc", &p.monitor->time_to_collision},
          {"stopm", &p.monitor->stop_margin},
          {"slowv", &p.monitor->slow_speed},
          {"dev", &p.replan.deviation},
          {"dearer", &p.dearer},
          {"hit", &p.mapper.hit},
          {"miss", &p.mapper.miss},
          {"mrange", &p.mapper.max_range},
          {"acc", &d.acceleration},
          {"dec", &d.deceleration},
          {"alpha", &d.turn_acceleration}};
}

Result run(const Contender& contender, const BarnWorld& world, int seed, bool trace) {
  static const sim::RobotModel model = [] {
    sim::RobotModel jackal = sim::load_robot_model(KERVAN_SOURCES "/sim/robots/jackal.yaml");
    jackal.laser->max_range = 8.0;
    return jackal;
  }();
  const auto place = std::make_shared<const sim::World>(sim::Obstacles{.circles = world.cylinders}, "barn");
  sim::RobotSetup setup{.name = "r1", .model = model, .start = world.start};
  setup.laser = {.noise = 0.0, .noise_share = 0.01};
  setup.laser_period = 50ms;
  setup.odometry.drift = contender.drift;
  sim::Simulation simulation(place, {setup}, static_cast<std::uint64_t>(seed));
  BarnRobot robot(contender.params, world.goal);
  observe::BarnScore judge({.goal = world.goal, .reference = world.optimal});
  while (judge.outcome() == BarnOutcome::running) {
    robot.step(simulation);
    const sim::Robot& body = simulation.robots().front();
    if (body.body().contacts() > 0) judge.contact();
    judge.truth(sim::seconds(simulation.now()), body.pose().position());
    if (trace && simulation.now() % 100ms == 0ms)
      std::printf(
          "%6.2f  (%6.3f %6.3f %6.1f)  v %5.2f w %5.2f  cmd %5.2f %5.2f  target (%6.2f %6.2f)  room %.3f cost %.2f %s  "
          "points %zu plan %zu %s n %llu\n",
          sim::seconds(simulation.now()), body.pose().x, body.pose().y, body.pose().yaw * 57.2958, body.speed().linear,
          body.speed().angular, robot.last().twist.linear, robot.last().twist.angular, robot.target().x(),
          robot.target().y(), robot.last().clearance, robot.last().cost, std::string(robot.last().why).c_str(),
          robot.points().size(), robot.plan().points.size(), std::string(robot.plan().why).c_str(),
          (unsigned long long)robot.plans());
  }
  return {world.number,
          seed,
          judge.outcome(),
          judge.time(),
          judge.metric(),
          judge.length(),
          simulation.robots().front().body().min_clearance()};
}

}  // namespace
}  // namespace kervan::test

int main(int argc, char** argv) {
  using namespace kervan::test;
  using kervan::observe::BarnOutcome;
  Options options;
  CLI::App app("How a robot drives through the worlds of BARN.");
  app.add_flag("--smoke", options.smoke, "one world, one seed");
  app.add_option("--robot", options.robots);
  app.add_option("--world", options.worlds);
  app.add_option("--every", options.every);
  app.add_option("--offset", options.offset);
  app.add_option("--seeds", options.seeds)->check(CLI::PositiveNumber);
  app.add_flag("--trace", options.trace);
  app.add_option("--set", options.set);
  CLI11_PARSE(app, argc, argv)
  const auto worlds = barn_worlds(barn_folder());
  if (worlds.empty()) {
    std::printf("there are no worlds of BARN in %s\n", barn_folder().c_str());
    return 0;
  }
  for (Contender& contender : contenders()) {
    if (!options.robots.empty() &&
        std::find(options.robots.begin(), options.robots.end(), contender.name) == options.robots.end())
      continue;
    for (const auto& set : options.set) {
      const auto eq = set.find('=');
      auto s = settings(contender.params);
      if (!s.contains(set.substr(0, eq))) {
        std::printf("no %s\n", set.c_str());
        return 2;
      }
      *s[set.substr(0, eq)] = std::stod(set.substr(eq + 1));
    }
    double metric = 0, time = 0, clearance = 1e9;
    int runs = 0, count[4] = {};
    const auto begin = std::chrono::steady_clock::now();
    double simulated = 0;
    for (const BarnWorld& world : worlds) {
      if (!options.worlds.empty() &&
          std::find(options.worlds.begin(), options.worlds.end(), world.number) == options.worlds.end())
        continue;
      if (world.number % options.every != options.offset) continue;
      for (int seed = 1; seed <= options.seeds; ++seed) {
        const Result r = run(contender, world, seed, options.trace);
        ++runs;
        ++count[static_cast<int>(r.outcome)];
        metric += r.metric;
        simulated += r.time;
        if (r.outcome == BarnOutcome::success) time += r.time;
        clearance = std::min(clearance, r.clearance);
        if (r.outcome != BarnOutcome::success || options.trace)
          std::printf("  world %d seed %d %s %.2f s %.2f m clearance %.3f metric %.3f\n", r.world, r.seed,
                      std::string(to_text(r.outcome)).c_str(), r.time, r.length, r.clearance, r.metric);
        else if (r.metric < 0.45)
          std::printf("  world %d seed %d slow %.2f s (%.2f) %.2f m metric %.3f\n", r.world, r.seed, r.time,
                      world.optimal, r.length, r.metric);
        std::fflush(stdout);
      }
    }
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    std::printf(
        "%s: runs %d success %.4f collision %.4f timeout %.4f metric %.4f time %.2f clearance %.3f  (%.1f s, %.1f x)\n",
        contender.name, runs, count[1] / double(runs), count[2] / double(runs), count[3] / double(runs), metric / runs,
        count[1] ? time / count[1] : 0.0, clearance, wall, simulated / wall);
  }
}
