// How a Cybermotion K2A fares by the virtual force field (components/control/vff.hpp): whether it swings along a wall,
// what false readings do to its way, and how near to each other rods may stand.
//
//   kervan_vff_experiment                     all experiments, 20 seeds
//   kervan_vff_experiment --smoke             one seed of each
//   kervan_vff_experiment --only rods --seeds 5
//
// The exit code is 1 if what is asked of an experiment does not hold.
#include "components/control/vff.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "components/mapping/sonar_mapper.hpp"
#include "sim/files/robot_file.hpp"
#include "sim/files/world_file.hpp"
#include "sim/random.hpp"
#include "sim/simulation.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using control::VffParams;
using geometry::Pose2;
using geometry::Vector2;

struct Options {
  int seeds = 20;
  std::string only;
  bool smoke = false;
};

/// What a drive is judged by. The robot knows where it is.
struct Drive {
  bool arrived = false;
  double time = 0.0;       // s, until it arrived or was given up
  double swinging = 0.0;   // rad/s, RMS of its turning rate
  double slowest = 0.0;    // m/s, from 2 s after the start to 2 s before the end
  double clearance = 0.0;  // m, the least
  bool touched = false;
  std::vector<Vector2> way;  // every 100 ms
};

struct Course {
  std::shared_ptr<const sim::World> world;
  Pose2 start;
  Vector2 goal;
  double limit = 200.0;  // s
};

/// How the robot's sonars hear.
struct Hearing {
  const char* name;
  sim::SonarSettings sonar;
  std::chrono::milliseconds period;  // between two rounds
};

/// With cones as the simulator has them, as compositions have it unless they say otherwise.
const Hearing cones{"cones", {}, 100ms};
/// Smooth walls throw away what meets them at a glancing angle.
const Hearing smooth_walls{"cones, smooth walls", {.incidence_limit = geometry::radians(25.0)}, 100ms};
/// Where the certainty grid puts an echo, on the axis, is where it comes from.
const Hearing axes{"axes", {.rays = 1}, 100ms};
/// The same; six at once, as the robot's file has it, so that all 24 have had their turn after 160 ms.
const Hearing axes_in_turn{"axes, in turn", {.rays = 1, .firing = sim::SonarFiring::sequential}, 40ms};

constexpr double arrive_within = 0.6;  // m

/// The readings of which one in so many is false: each as likely to come from anywhere the sonar hears.
double falsified(double range, double share, sim::RandomSource::Sequence& random, const sim::SonarRing& ring) {
  const bool false_one = random.happens(share);
  const double other = random.uniform(ring.min_range, ring.max_range);
  return false_one && !std::isnan(range) ? other : range;
}

/// As control/vff does it: what is heard counts in the next period.
Drive drive(const Course& course, const VffParams& params, const Hearing& hearing, int seed, double false_share = 0.0) {
  static const sim::RobotModel model = sim::load_robot_model(KERVAN_SOURCES "/sim/robots/k2a.yaml");
  sim::RobotSetup setup{.name = "r1", .model = model, .start = course.start, .sonar = hearing.sonar};
  setup.sonar_period = hearing.period;
  sim::Simulation simulation(course.world, {setup}, static_cast<std::uint64_t>(seed));
  const sim::RandomSource random(static_cast<std::uint64_t>(seed), "false readings");
  const sim::SonarRing& ring = model.sonars;
  mapping::SonarMapper mapper(
      {.update = mapping::UpdateRule::himm, .model = {}, .resolution = 0.1, .no_echo_limit = 2.0});
  control::VirtualForceField field(params);
  control::CertaintyWindow window;
  Drive result;
  double squares = 0.0;
  std::vector<double> speeds;
  int steps = 0;
  for (; sim::seconds(simulation.now()) < course.limit && !result.arrived; ++steps) {
    const sim::Robot& robot = simulation.robots()[0];
    if (simulation.now() % 100ms == 0ms) {
      control::cut_window(*mapper.certainties(), robot.pose().position(), window);
      simulation.command(0, field.step({robot.pose(), robot.speed()}, course.goal, window).twist);
      result.way.push_back(robot.pose().position());
      speeds.push_back(robot.speed().linear);
    }
    if (robot.sonar().stamp == simulation.now()) {
      auto draws = random.at(sim::RandomUse::sonar, 97, static_cast<std::uint64_t>(steps));
      for (std::size_t i = 0; i < ring.poses.size(); ++i)
        mapper.add(robot.pose() * robot.mounted(ring.poses[i]),
                   falsified(robot.sonar().ranges[i], false_share, draws, ring), {ring.min_range, ring.max_range});
    }
    simulation.step(10ms);
    const double turning = simulation.robots()[0].speed().angular;
    squares += turning * turning;
    result.arrived = (simulation.robots()[0].pose().position() - course.goal).norm() <= arrive_within;
  }
  const sim::Body& body = simulation.robots()[0].body();
  result.time = sim::seconds(simulation.now());
  result.swinging = std::sqrt(squares / std::max(1, steps));
  result.clearance = body.min_clearance();
  result.touched = body.contacts() > 0;
  constexpr std::ptrdiff_t ends = 20;
  if (std::ssize(speeds) > 2 * ends) result.slowest = *std::min_element(speeds.begin() + ends, speeds.end() - ends);
  return result;
}

std::shared_ptr<const sim::World> shipped(const char* name) {
  return std::make_shared<const sim::World>(sim::load_world(std::string(KERVAN_SOURCES "/sim/worlds/") + name));
}

/// Of all seeds.
struct Drives {
  int arrived = 0, touched = 0;
  double swinging = 0.0, time = 0.0;  // sums
  double least_swinging = std::numeric_limits<double>::infinity(), most_swinging = 0.0;
};

Drives drive_all(const Course& course, const VffParams& params, const Hearing& hearing, const Options& options) {
  Drives drives;
  for (int seed = 1; seed <= options.seeds; ++seed) {
    const Drive result = drive(course, params, hearing, seed);
    drives.arrived += result.arrived;
    drives.touched += result.touched;
    drives.swinging += result.swinging;
    drives.time += result.time;
    drives.least_swinging = std::min(drives.least_swinging, result.swinging);
    drives.most_swinging = std::max(drives.most_swinging, result.swinging);
  }
  return drives;
}

/// 30 m along a wall 1.0 m to the right, at 0.7 m/s.
Course wall() { return {shipped("long_wall.yaml"), {0.0, 0.0, 0.0}, {30.0, 0.0}}; }
constexpr double beside_wall = 0.7;  // m/s

struct Arm {
  const char* name;
  double tau;  // of eq. 7; T: none
  double w;    // of eq. 8; 1: none
};

bool damping(const Options& options) {
  std::printf(
      "\ndamping: along a wall 1.0 m off, 0.7 m/s; RMS of the turning rate in rad/s\n"
      "| sonars | equations | mean | least | most | arrived | touched the wall | time, mean |\n"
      "|---|---|---|---|---|---|---|---|\n");
  const std::vector<Arm> arms{
      {"neither 7 nor 8", 0.1, 1.0}, {"7 alone", 0.4, 1.0}, {"8 alone", 0.1, 0.25}, {"7 and 8", 0.4, 0.25}};
  bool good = true;
  for (const Hearing* hearing : {&axes, &axes_in_turn, &smooth_walls, &cones}) {
    std::vector<double> sums;
    for (const Arm& arm : arms) {
      const Drives drives = drive_all(wall(), {.tau = arm.tau, .w = arm.w, .v_max = beside_wall}, *hearing, options);
      std::printf("| %s | %s | %.3f | %.3f | %.3f | %d of %d | %d | %.1f s |\n", hearing->name, arm.name,
                  drives.swinging / options.seeds, drives.least_swinging, drives.most_swinging, drives.arrived,
                  options.seeds, drives.touched, drives.time / options.seeds);
      std::fflush(stdout);
      sums.push_back(drives.swinging);
      if (hearing == &axes || hearing == &axes_in_turn)
        good = good && drives.arrived == options.seeds && drives.touched == 0;
    }
    const double share = sums.back() / sums.front();
    std::printf("%s: with both %.2f times as much as with neither%s\n", hearing->name, share,
                hearing == &axes || hearing == &axes_in_turn ? "; asked: at most 0.50, and no contact" : "");
    if (hearing == &axes || hearing == &axes_in_turn) good = good && share <= 0.5;
  }
  return good;
}

/// The farthest that `way` is from where `other` is at the same x, m.
double apart(const std::vector<Vector2>& way, const std::vector<Vector2>& other) {
  double most = 0.0;
  std::size_t next = 1;
  for (const Vector2& at : way) {
    while (next + 1 < other.size() && other[next].x() < at.x()) ++next;
    const Vector2 &a = other[next - 1], &b = other[next];
    const double part = b.x() > a.x() ? std::clamp((at.x() - a.x()) / (b.x() - a.x()), 0.0, 1.0) : 0.0;
    most = std::max(most, std::abs(at.y() - (a.y() + part * (b.y() - a.y()))));
  }
  return most;
}

bool false_readings(const Options& options) {
  constexpr double most_apart = 0.5;  // m
  std::printf(
      "\nfalse_readings: how far the way is from that of the same seed without any, m; asked: at most %.2f\n"
      "| false | along the wall, mean | most | in the open, mean | most |\n|---|---|---|---|---|\n",
      most_apart);
  const auto open = std::make_shared<const sim::World>(sim::Obstacles{});
  const std::vector<Course> courses{wall(), {open, {0.0, 0.0, 0.0}, {30.0, 0.0}}};
  bool good = true;
  for (const double share : {0.01, 0.05, 0.10}) {
    std::printf("| %.0f %% |", 100.0 * share);
    for (const Course& course : courses) {
      double sum = 0.0, most = 0.0;
      for (int seed = 1; seed <= options.seeds; ++seed) {
        const VffParams params{.v_max = beside_wall};
        const Drive clean = drive(course, params, axes, seed), disturbed = drive(course, params, axes, seed, share);
        const double off = apart(disturbed.way, clean.way);
        good = good && disturbed.arrived && !disturbed.touched;
        sum += off / options.seeds;
        most = std::max(most, off);
      }
      good = good && most <= most_apart;
      std::printf(" %.3f | %.3f |", sum, most);
      std::fflush(stdout);
    }
    std::printf("\n");
  }
  return good;
}

/// Rods of 5 cm radius in 24 m x 16 m, thrown until none fits any more between others with `gap` m free.
std::shared_ptr<const sim::World> rods(double gap, int seed) {
  auto random = sim::RandomSource(static_cast<std::uint64_t>(seed), "rods").at(sim::RandomUse::sonar, 96, 0);
  sim::Obstacles obstacles;
  for (int tries = 0; tries < 4000; ++tries) {
    const double x = random.uniform(0.0, 24.0), y = random.uniform(0.0, 16.0);
    const auto near = [&](const sim::Circle& rod) { return (rod.center - Vector2(x, y)).norm() < gap + 0.1; };
    if (std::none_of(obstacles.circles.begin(), obstacles.circles.end(), near))
      obstacles.circles.push_back({{x, y}, 0.05});
  }
  return std::make_shared<const sim::World>(std::move(obstacles));
}

bool rod_fields(const Options& options) {
  constexpr double far_apart = 3.0;  // m
  std::printf(
      "\nrods: 28 m through fields of rods, another field each seed, 200 s at most\n"
      "| free between rods | f_cr | arrived | touched a rod | slowest | least clearance | time, mean |\n"
      "|---|---|---|---|---|---|---|\n");
  bool good = true;
  for (const double gap : {3.4, 3.0, 2.6, 2.2, 1.8, 1.4})
    for (const double f_cr : {0.01, 0.02}) {
      int arrived = 0, touched = 0;
      double slowest = std::numeric_limits<double>::infinity(), clearance = slowest, time = 0.0;
      for (int seed = 1; seed <= options.seeds; ++seed) {
        // Not exactly in line with a rod: there the forces have no side to which they would turn it.
        const double y = sim::RandomSource(static_cast<std::uint64_t>(seed), "start")
                             .at(sim::RandomUse::sonar, 95, 0)
                             .uniform(7.5, 8.5);
        const Course course{rods(gap, seed), {-2.0, y, 0.0}, {26.0, y}};
        const Drive result = drive(course, {.f_cr = f_cr}, cones, seed);
        arrived += result.arrived;
        touched += result.touched;
        clearance = std::min(clearance, result.clearance);
        slowest = std::min(slowest, result.slowest);
        if (result.arrived) time += result.time;
      }
      if (gap >= far_apart) good = good && arrived == options.seeds && touched == 0;
      std::printf("| %.1f m | %.2f | %d of %d | %d | %.2f m/s | %.2f m | %.0f s |\n", gap, f_cr, arrived, options.seeds,
                  touched, slowest, clearance, time / std::max(1, arrived));
      std::fflush(stdout);
    }
  std::printf("asked from %.1f m on: all arrive, no contact\n", far_apart);
  return good;
}

}  // namespace
}  // namespace kervan::test

int main(int argc, char** argv) {
  using namespace kervan::test;
  struct Experiment {
    const char* name;
    bool (*table)(const Options&);
  };
  const std::vector<Experiment> experiments{
      {"damping", damping}, {"false_readings", false_readings}, {"rods", rod_fields}};
  Options options;
  std::vector<std::string> names;
  for (const Experiment& experiment : experiments) names.emplace_back(experiment.name);
  CLI::App app("How a fast robot fares by the virtual force field.");
  app.add_flag("--smoke", options.smoke, "one seed of each");
  app.add_option("--seeds", options.seeds)->check(CLI::PositiveNumber);
  app.add_option("--only", options.only, "one experiment")->check(CLI::IsMember(names));
  CLI11_PARSE(app, argc, argv)
  if (options.smoke) options.seeds = 1;
  try {
    bool good = true;
    for (const Experiment& experiment : experiments)
      if (options.only.empty() || options.only == experiment.name) good = experiment.table(options) && good;
    return good ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
