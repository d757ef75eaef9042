// Wall following in worlds of corners: seeds x worlds x sides, with sonar noise.
//
//   kervan_wall_follow_experiment               all experiments, 20 seeds
//   kervan_wall_follow_experiment --smoke       one seed of each
//   kervan_wall_follow_experiment --only paper_law --seeds 3 --world room.yaml --trace 2
//
// The exit code is 1 if what is asked of an experiment does not hold.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "sim/files/robot_file.hpp"
#include "sim/files/world_file.hpp"
#include "tests/experiments/behaving_robot.hpp"
#include "tests/experiments/lap_judge.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using behavior::FollowLaw;
using behavior::Side;
using geometry::Pose2;
using geometry::Vector2;

struct Place {
  const char* file;   // from the sources' root
  Vector2 middle;     // a lap goes round it
  Vector2 low, high;  // random starts are drawn between these corners
  bool indoors;       // and on the same side of the walls as the middle
  const char* name() const { return std::strrchr(file, '/') + 1; }
};

const std::vector<Place> places{
    {"sim/worlds/corner_90", {0, 0}, {-4.5, -3.5}, {4.5, 3.5}, false},
    {"sim/worlds/corner_180", {0, 0}, {-5, -3}, {5, 3}, false},
    {"sim/worlds/corner_thick", {0, 0}, {-5, -3}, {5, 3}, false},
    {"sim/worlds/room", {5, 3}, {0.5, 0.5}, {7.5, 5.5}, true},
    {"tests/experiments/worlds/square", {0, 0}, {-3, -2.5}, {3, 2.5}, true},
    {"tests/experiments/worlds/alcove", {4.5, 4.5}, {0.5, 0.5}, {8.5, 8.5}, true},
};

/// What stands in the robot's way that no sonar hears.
enum class Post { none, ahead, beside };

struct Experiment {
  const char* name;
  const char* help;
  FollowLaw law = FollowLaw::proportional;
  double incidence = 90.0;      // degrees; walls met more obliquely are not heard
  bool starts_anywhere = true;  // or beside a wall
  Post post = Post::none;
  sim::BumperSet bumpers = sim::BumperSet::none;
  double least_band = 0.0;  // asked for, as the mean of a world
  bool may_touch = false;
};

const std::vector<Experiment> experiments{
    {.name = "corners", .help = "proportional law, all surfaces heard, random starts", .least_band = 0.9},
    {.name = "incidence",
     .help = "surfaces met at more than 25 degrees are not heard, random starts",
     .incidence = 25.0},
    {.name = "paper_law", .help = "the paper's law of fixed steps, random starts", .law = FollowLaw::paper},
    {.name = "low_post",
     .help = "a low post in the way, which the bumpers feel",
     .starts_anywhere = false,
     .post = Post::ahead,
     .bumpers = sim::BumperSet::both,
     .may_touch = true},
    {.name = "stalled",
     .help = "a low post in the way, no bumpers: wheels stall",
     .starts_anywhere = false,
     .post = Post::ahead,
     .may_touch = true},
    {.name = "caught",
     .help = "a low post catches one side of the robot, no bumpers",
     .starts_anywhere = false,
     .post = Post::beside,
     .may_touch = true},
};

struct Options {
  int seeds = 20;
  int trace = 0;
  double time = 500.0;  // s
  std::string only, world;
  bool smoke = false;
};

struct Outcome {
  double laps = 0.0, in_band = 0.0, clearance = 0.0;
  std::optional<double> found;
  int with_post = 0, with_walls = 0;  // touches
};

sim::RandomSource::Sequence draws(const Place& place, int seed) {
  return sim::RandomSource(static_cast<std::uint64_t>(seed), place.name()).at(sim::RandomUse::sonar, 99, 0);
}

/// Not outside of a room: from there its middle is behind an odd number of walls.
bool reachable(const sim::World& world, const Place& place, const Vector2& at) {
  if (!place.indoors) return true;
  const Vector2 way = at - place.middle;
  int crossed = 0;
  for (const sim::Segment& wall : world.segments()) {
    const auto side = [](const Vector2& from, const Vector2& along, const Vector2& point) {
      return along.x() * (point.y() - from.y()) - along.y() * (point.x() - from.x()) > 0.0;
    };
    const Vector2 along = wall.b - wall.a;
    crossed += side(place.middle, way, wall.a) != side(place.middle, way, wall.b) &&
               side(wall.a, along, place.middle) != side(wall.a, along, at);
  }
  return crossed % 2 == 0;
}

/// Anywhere with room to turn.
Pose2 random_start(const sim::World& world, const Place& place, int seed) {
  auto random = draws(place, seed);
  for (;;) {
    const Vector2 at(random.uniform(place.low.x(), place.high.x()), random.uniform(place.low.y(), place.high.y()));
    const double yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
    if (!world.nearest(at, 0.45) && reachable(world, place, at)) return {at.x(), at.y(), yaw};
  }
}

std::vector<sim::Segment> walls_of(const sim::World& world) {
  std::vector<sim::Segment> walls(world.segments().begin(), world.segments().end());
  for (const sim::Box& box : world.boxes()) {
    const auto corners = sim::corners(box);
    for (std::size_t i = 0; i < corners.size(); ++i) walls.push_back({corners[i], corners[(i + 1) % corners.size()]});
  }
  return walls;
}

/// About 0.4 m beside the first half of one of the long walls, along it.
Pose2 start_beside(const sim::World& world, const Place& place, Side side, int seed) {
  auto random = draws(place, seed);
  const auto walls = walls_of(world);
  const double sign = side == Side::right ? 1.0 : -1.0;
  for (;;) {
    const sim::Segment& wall = walls[static_cast<std::size_t>(random.uniform() * static_cast<double>(walls.size()))];
    const bool forward = random.uniform() < 0.5;
    const Vector2 from = forward ? wall.a : wall.b, to = forward ? wall.b : wall.a;
    const double length = (to - from).norm(), part = random.uniform(0.2, 0.5);
    const double off = random.uniform(0.50, 0.58), slant = random.uniform(-0.08, 0.08);
    if (length < 2.5) continue;
    const Vector2 along = (to - from) / length, normal(-sign * along.y(), sign * along.x());
    const Vector2 at = from + part * (to - from) + off * normal;
    const double yaw = std::atan2(along.y(), along.x()) + slant;
    // Within the course, and not on the far side of its walls.
    const bool inside = (at.array() > place.low.array() - 0.5).all() && (at.array() < place.high.array() + 0.5).all();
    if (inside && !world.nearest(at, 0.45) && reachable(world, place, at)) return {at.x(), at.y(), yaw};
  }
}

/// The world with a post 1.2 m before the robot: in its way, or where it catches the side away from the wall.
sim::World with_post(const sim::World& world, const Pose2& start, Side side, Post post, int seed) {
  auto random = sim::RandomSource(static_cast<std::uint64_t>(seed), "post").at(sim::RandomUse::sonar, 98, 0);
  const double aside = post == Post::ahead ? random.uniform(-0.08, 0.08) : random.uniform(0.17, 0.22);
  const Vector2 at = start * Vector2(1.2, side == Side::right ? aside : -aside);
  sim::Obstacles obstacles;
  obstacles.segments.assign(world.segments().begin(), world.segments().end());
  obstacles.boxes.assign(world.boxes().begin(), world.boxes().end());
  obstacles.low.circles.push_back({at, 0.04});
  return sim::World(std::move(obstacles), world.name());
}

Outcome run(const Experiment& experiment, const Place& place, Side side, int seed, const Options& options) {
  sim::World world = sim::load_world(std::string(KERVAN_SOURCES "/") + place.file + ".yaml");
  const Pose2 start =
      experiment.starts_anywhere ? random_start(world, place, seed) : start_beside(world, place, side, seed);
  if (experiment.post != Post::none) world = with_post(world, start, side, experiment.post, seed);
  const auto shared = std::make_shared<const sim::World>(std::move(world));
  sim::RobotModel model = sim::load_robot_model(KERVAN_SOURCES "/sim/robots/p3dx.yaml");
  if (experiment.bumpers != sim::BumperSet::none) model = sim::with_bumpers(std::move(model), experiment.bumpers);
  sim::RobotSetup setup{.name = "r1", .model = std::move(model), .start = start};
  if (experiment.incidence < 90.0) setup.sonar.incidence_limit = geometry::radians(experiment.incidence);
  sim::Simulation simulation(shared, {setup}, static_cast<std::uint64_t>(seed));
  BehavingRobot robot({.side = side, .follow = {.law = experiment.law}});
  LapJudge judge(*shared, place.middle, side);
  std::string before;
  std::uint64_t touched = 0;
  int with_walls = 0;
  while (sim::seconds(simulation.now()) < options.time) {
    robot.step(simulation);
    const sim::Body& body = simulation.robots()[0].body();
    const Pose2& pose = body.pose();
    const auto trace = [&](const std::string& what, const std::string& why) {
      if (options.trace == 0) return;
      std::printf("%8.2f %6.2f %6.2f %7.1f  %-14s %s\n", sim::seconds(simulation.now()), pose.x, pose.y,
                  pose.yaw * 180.0 / std::numbers::pi, what.c_str(), why.c_str());
    };
    if (simulation.now() % 100ms == 0ms) judge.add(sim::seconds(simulation.now()), pose);
    const std::string now = robot.decision().behaviour + robot.decision().why;
    if (now != before) trace(robot.decision().behaviour, robot.decision().why);
    before = now;
    if (body.contacts() == touched) continue;
    touched = body.contacts();
    const Vector2 at = body.last_contact().point;
    const auto low = shared->low().circles();
    const bool post = !low.empty() && (at - low.front().center).norm() < low.front().radius + 1e-3;
    with_walls += !post;
    trace("touches", post ? "the post" : "a wall");
  }
  if (!robot.always_somebody()) throw std::logic_error("at some time no behaviour was active");
  const sim::Body& body = simulation.robots()[0].body();
  return {judge.laps(), judge.in_band(), body.min_clearance(), judge.found(), static_cast<int>(touched) - with_walls,
          with_walls};
}

/// One row of the table; true if what is asked holds.
bool row(const Experiment& experiment, const Place& place, Side side, const Options& options) {
  double laps = 0.0, least_laps = 1e9, band = 0.0, least_band = 1.0, found = 0.0, clearance = 1e9;
  int runs = 0, with_post = 0, with_walls = 0, lapped = 0;
  for (int seed = 1; seed <= options.seeds; ++seed) {
    if (options.trace != 0 && seed != options.trace) continue;
    const Outcome outcome = run(experiment, place, side, seed, options);
    ++runs;
    laps += outcome.laps;
    least_laps = std::min(least_laps, outcome.laps);
    band += outcome.in_band;
    least_band = std::min(least_band, outcome.in_band);
    found = std::max(found, outcome.found.value_or(options.time));
    clearance = std::min(clearance, outcome.clearance);
    with_post += outcome.with_post;
    with_walls += outcome.with_walls;
    lapped += outcome.laps >= 1.0;
    if (outcome.laps < 1.0 || outcome.with_walls > 0)
      std::printf("  seed %d: %.2f laps, %d contacts with walls\n", seed, outcome.laps, outcome.with_walls);
  }
  std::printf("%-11s %-6s %8d/%-3d %6.2f %6.2f %5d %5d %9.3f %8.3f %7.3f %9.1f\n", place.name(),
              side == Side::right ? "right" : "left", lapped, runs, laps / runs, least_laps, with_walls, with_post,
              clearance, band / runs, least_band, found);
  std::fflush(stdout);
  return lapped == runs && (with_walls == 0 || experiment.may_touch) && band / runs >= experiment.least_band;
}

bool table(const Experiment& experiment, const Options& options) {
  std::printf("\n%s: %s; %.0f s each\n%-11s %-6s %12s %6s %6s %5s %5s %9s %8s %7s %9s\n", experiment.name,
              experiment.help, options.time, "world", "side", "lapped", "laps", "least", "walls", "post", "clearance",
              "in band", "least", "found (s)");
  bool good = true;
  for (const Place& place : places)
    for (const Side side : {Side::right, Side::left})
      if (options.world.empty() || options.world == place.name())
        if (!options.smoke || side == Side::right || experiment.name == std::string("corners"))
          good = row(experiment, place, side, options) && good;
  return good;
}

}  // namespace
}  // namespace kervan::test

int main(int argc, char** argv) {
  using namespace kervan::test;
  Options options;
  std::vector<std::string> names, worlds;
  for (const Experiment& experiment : experiments) names.emplace_back(experiment.name);
  for (const Place& place : places) worlds.emplace_back(place.name());
  CLI::App app("How well the behaviours follow walls.");
  app.add_flag("--smoke", options.smoke, "one seed, few worlds");
  app.add_option("--seeds", options.seeds)->check(CLI::PositiveNumber);
  app.add_option("--trace", options.trace, "the seed whose run is printed step by step")->check(CLI::PositiveNumber);
  app.add_option("--time", options.time, "of a run, s")->check(CLI::PositiveNumber);
  app.add_option("--only", options.only, "one experiment")->check(CLI::IsMember(names));
  app.add_option("--world", options.world)->check(CLI::IsMember(worlds));
  CLI11_PARSE(app, argc, argv)
  if (options.smoke) options.seeds = 1;
  options.seeds = std::max(options.seeds, options.trace);
  try {
    bool good = true;
    for (const Experiment& experiment : experiments)
      if (options.only.empty() || options.only == experiment.name) good = table(experiment, options) && good;
    return good ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
