// BARN: a robot drives ten metres through clutter that it does not know, in 150 worlds.
//
//   kervan_barn_experiment                        all robots, all worlds, 3 seeds
//   kervan_barn_experiment --smoke                every robot once, in a world of our own
//   kervan_barn_experiment --robot stack --world 12 92 --seeds 1 --pictures FOLDER
//
// The worlds are those of data/barn (barn_world.hpp). The exit code is 1 if a robot does not succeed as often as is
// asked of it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "components/observe/barn_score.hpp"
#include "components/observe/map_drawing.hpp"
#include "components/observe/polyline.hpp"
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
  const char* model;
  BarnRobotParams params;
  double drift = 0.0;
  double success = 0.0, metric = 0.0;  ///< asked for, at least
  double collisions = 1.0;             ///< at most
};

BarnRobotParams jackal(double v_max) {
  BarnRobotParams params;
  params.planner.costs = {.radius = 0.27, .clearance = 0.35, .clearance_cost = 6.0};
  params.dwa.v_max = v_max;
  params.guard = {.period = 10ms,
                  .max_speed = 2.0,
                  .max_turn = 2.5,
                  .acceleration = 2.5,
                  .deceleration = 2.5,
                  .turn_acceleration = 6.0};
  params.monitor.emplace();
  return params;
}

BarnRobotParams pioneer() {
  BarnRobotParams params;
  // Far echoes of such wide cones would close every gap.
  params.mapper = mapping::SonarMapperParams{.model = {.max_range = 2.0}, .no_echo_limit = 1.5};
  params.planner.costs = {.radius = 0.22, .clearance = 0.35, .clearance_cost = 6.0};
  const geometry::RectangularHull hull{.front = 0.211, .rear = 0.300, .half_width = 0.200};
  params.seen = {.reach = 1.5, .memory = 1s};
  params.dwa.hull = hull;
  params.dwa.v_max = 0.6;
  params.dwa.turn_rate = 1.2;
  params.dwa.acceleration = 0.3;
  params.dwa.deceleration = 0.6;
  params.dwa.turn_acceleration = 1.74;
  params.dwa.window = 0.6;
  params.guard = {.period = 10ms,
                  .max_speed = 1.0,
                  .max_turn = 1.74,
                  .acceleration = 0.3,
                  .deceleration = 0.6,
                  .turn_acceleration = 1.74};
  params.monitor.emplace();
  params.monitor->hull = hull;
  return params;
}

std::vector<Contender> contenders() {
  return {
      {.name = "baseline", .help = "the stack at up to 0.5 m/s", .model = "jackal", .params = jackal(0.5)},
      {.name = "stack",
       .help = "the stack at up to 1.3 m/s",
       .model = "jackal",
       .params = jackal(1.3),
       .success = 0.97,
       .metric = 0.47,
       .collisions = 0.01},
      {.name = "drifting",
       .help = "the same, odometry with 1 % drift",
       .model = "jackal",
       .params = jackal(1.3),
       .drift = 0.01},
      {.name = "fast", .help = "the stack at up to 2 m/s", .model = "jackal", .params = jackal(2.0)},
      {.name = "p3dx", .help = "a P3-DX with sonars only", .model = "p3dx", .params = pioneer()},
  };
}

struct Options {
  bool smoke = false;
  std::vector<std::string> robots;
  std::vector<int> worlds;
  int every = 1, seeds = 3;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::string pictures;
};

struct Run {
  int world = 0, seed = 0;
  BarnOutcome outcome = BarnOutcome::running;
  double time = 0.0, metric = 0.0, length = 0.0;  // s, -, m
  double clearance = 0.0;                         // m, the least
  geometry::Vector2 end = geometry::Vector2::Zero();
};

sim::RobotSetup setup_of(const Contender& contender, const BarnWorld& world) {
  sim::RobotSetup setup{
      .name = "r1",
      .model = sim::load_robot_model(KERVAN_SOURCES "/sim/robots/" + std::string(contender.model) + ".yaml"),
      .start = world.start};
  if (setup.model.laser) setup.model.laser->max_range = 8.0;
  setup.laser = {.noise = 0.0, .noise_share = 0.01};
  setup.laser_period = 50ms;
  setup.odometry.drift = contender.drift;
  return setup;
}

void save_picture(const std::string& path, const Contender& contender, const BarnWorld& world, const Run& run,
                  const observe::DrawnRobot& drawn) {
  char subtitle[120];
  std::snprintf(subtitle, sizeof subtitle, "seed %d: %s after %.1f s and %.1f m, least clearance %.3f m", run.seed,
                std::string(to_text(run.outcome)).c_str(), run.time, run.length, run.clearance);
  observe::MapDrawing drawing;
  drawing.title = "world " + std::to_string(world.number) + " of BARN, " + contender.help;
  drawing.result = run.outcome == BarnOutcome::success ? "success" : "failed";
  drawing.subtitle = subtitle;
  for (const sim::Circle& circle : world.cylinders) drawing.world.circles.push_back({circle.center, circle.radius});
  for (const sim::Segment& wall : world.walls) drawing.world.walls.emplace_back(wall.a, wall.b);
  drawing.robots.push_back(drawn);
  std::ofstream(path) << to_svg(drawing);
}

Run drive(const Contender& contender, const BarnWorld& world, int seed, const Options& options) {
  const auto place =
      std::make_shared<const sim::World>(sim::Obstacles{.segments = world.walls, .circles = world.cylinders}, "barn");
  sim::Simulation simulation(place, {setup_of(contender, world)}, static_cast<std::uint64_t>(seed));
  BarnRobot robot(contender.params, world.goal);
  observe::BarnScore judge({.goal = world.goal, .reference = world.optimal});
  observe::DrawnRobot drawn;
  drawn.name = contender.name;
  drawn.goal = world.goal;
  drawn.tolerance = 1.0;
  const sim::Robot& body = simulation.robots().front();
  while (judge.outcome() == BarnOutcome::running) {
    robot.step(simulation);
    if (body.body().contacts() > 0) judge.contact();
    judge.truth(sim::seconds(simulation.now()), body.pose().position());
    if (simulation.now() % 50ms == 0ms) drawn.truth.push_back(body.pose().position());
  }
  const Run run{world.number,
                seed,
                judge.outcome(),
                judge.time(),
                judge.metric(),
                judge.length(),
                body.body().min_clearance(),
                body.pose().position()};
  if (!options.pictures.empty() && (run.outcome != BarnOutcome::success || !options.worlds.empty())) {
    drawn.truth = observe::simplified(drawn.truth, 0.01);
    drawn.route = robot.route();
    drawn.reached = run.outcome == BarnOutcome::success;
    if (run.outcome == BarnOutcome::collision) drawn.contacts.push_back(run.end);
    save_picture(options.pictures + "/barn_" + contender.name + "_" + std::to_string(run.world) + "_" +
                     std::to_string(run.seed) + ".svg",
                 contender, world, run, drawn);
  }
  return run;
}

/// All worlds and seeds, on several threads; the results do not depend on how many.
std::vector<Run> all_runs(const Contender& contender, const std::vector<BarnWorld>& worlds, const Options& options) {
  const auto seeds = static_cast<std::size_t>(options.seeds);
  std::vector<Run> runs(worlds.size() * seeds);
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < runs.size(); i = next++)
      runs[i] = drive(contender, worlds[i / seeds], static_cast<int>(i % seeds) + 1, options);
  };
  std::vector<std::jthread> threads;
  for (int i = 1; i < options.threads; ++i) threads.emplace_back(work);
  work();
  threads.clear();
  return runs;
}

/// A row of the table; whether the robot did what is asked of it.
bool judge(const Contender& contender, const std::vector<Run>& runs) {
  const auto count = static_cast<double>(runs.size());
  const auto share = [&](BarnOutcome outcome) {
    return static_cast<double>(
               std::count_if(runs.begin(), runs.end(), [&](const Run& run) { return run.outcome == outcome; })) /
           count;
  };
  double metric = 0.0, time = 0.0, clearance = 1e9;
  for (const Run& run : runs) {
    metric += run.metric / count;
    if (run.outcome == BarnOutcome::success) time += run.time / (share(BarnOutcome::success) * count);
    clearance = std::min(clearance, run.clearance);
  }
  std::printf("| `%s`: %s | %zu | %.4f | %.4f | %.4f | %.4f | %.2f s | %.3f m |\n", contender.name, contender.help,
              runs.size(), share(BarnOutcome::success), share(BarnOutcome::collision), share(BarnOutcome::timeout),
              metric, time, clearance);
  std::fflush(stdout);
  return share(BarnOutcome::success) >= contender.success && metric >= contender.metric &&
         share(BarnOutcome::collision) <= contender.collisions;
}

void list_failures(const Contender& contender, const std::vector<Run>& runs) {
  for (const Run& run : runs)
    if (run.outcome != BarnOutcome::success)
      std::printf("| `%s` | %d | %d | %s | %.1f s | (%.2f, %.2f) |\n", contender.name, run.world, run.seed,
                  std::string(to_text(run.outcome)).c_str(), run.time, run.end.x(), run.end.y());
}

/// What the challenge says of the DWA that it compares with, at 0.5 m/s, in those of the worlds where it has run.
void print_published(const std::vector<BarnWorld>& worlds) {
  int count = 0;
  double success = 0.0;
  for (const BarnWorld& world : worlds) {
    if (!world.published) continue;
    ++count;
    success += *world.published;
  }
  if (count > 0) std::printf("| the published DWA, in %d of the worlds | | %.4f | | | | | |\n", count, success / count);
}

bool table(const std::vector<BarnWorld>& worlds, const Options& options) {
  std::printf(
      "| robot | runs | success | collisions | timeouts | metric | mean time | least clearance |\n"
      "|---|---|---|---|---|---|---|---|\n");
  print_published(worlds);
  bool good = true;
  std::vector<std::pair<Contender, std::vector<Run>>> all;
  for (const Contender& contender : contenders()) {
    if (!options.robots.empty() && std::count(options.robots.begin(), options.robots.end(), contender.name) == 0)
      continue;
    all.emplace_back(contender, all_runs(contender, worlds, options));
    good = judge(contender, all.back().second) && good;
  }
  std::printf("\n| failed | world | seed | outcome | after | at |\n|---|---|---|---|---|---|\n");
  for (const auto& [contender, runs] : all) list_failures(contender, runs);
  return good;
}

std::vector<BarnWorld> chosen_worlds(const Options& options) {
  if (options.smoke) return {clutter_world()};
  std::vector<BarnWorld> worlds = barn_worlds(barn_folder());
  std::erase_if(worlds, [&](const BarnWorld& world) {
    return world.number / 2 % options.every != 0 ||
           (!options.worlds.empty() && std::count(options.worlds.begin(), options.worlds.end(), world.number) == 0);
  });
  return worlds;
}

}  // namespace
}  // namespace kervan::test

int main(int argc, char** argv) {
  using namespace kervan::test;
  Options options;
  std::vector<std::string> names;
  for (const Contender& contender : contenders()) names.emplace_back(contender.name);
  CLI::App app("How a robot drives through the worlds of BARN.");
  app.add_flag("--smoke", options.smoke, "every robot once, in a world of our own");
  app.add_option("--robot", options.robots)->check(CLI::IsMember(names));
  app.add_option("--world", options.worlds, "numbers of worlds; all runs in them are drawn");
  app.add_option("--every", options.every, "only each so many-th world")->check(CLI::PositiveNumber);
  app.add_option("--seeds", options.seeds)->check(CLI::PositiveNumber);
  app.add_option("--threads", options.threads)->check(CLI::PositiveNumber);
  app.add_option("--pictures", options.pictures, "folder for a picture of each run that failed")
      ->check(CLI::ExistingDirectory);
  CLI11_PARSE(app, argc, argv)
  if (options.smoke) options.seeds = 1;
  try {
    const std::vector<BarnWorld> worlds = chosen_worlds(options);
    if (worlds.empty()) {
      std::fprintf(stderr, "%s has none of these worlds\n", barn_folder().c_str());
      return 2;
    }
    return table(worlds, options) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
