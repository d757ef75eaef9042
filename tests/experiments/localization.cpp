// How well a robot whose wheels err knows where it is: dead reckoning beside scan matching with laser and with sonars,
// all three on the same drives.
//
//   kervan_localization_experiment                 all places and drifts, 20 seeds
//   kervan_localization_experiment --smoke         one short drive of each
//   kervan_localization_experiment --place hall --seeds 3 --time 100 --plots FOLDER
//
// The exit code is 1 if scan matching is not as much better as is asked.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "components/localization/laser_localizer.hpp"
#include "components/localization/sonar_localizer.hpp"
#include "sim/files/robot_file.hpp"
#include "sim/files/world_file.hpp"
#include "sim/simulation.hpp"
#include "tests/experiments/error_plot.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry::Pose2;
using localization::Outcome;

enum Method : std::size_t { by_wheels, by_laser, by_sonars, methods };
constexpr std::array<const char*, methods> names = {"dead reckoning", "laser", "sonars"};

struct Place {
  const char* name;
  Pose2 start;
};

const std::vector<Place> places{
    {"room", {1.5, 1.5, 0.0}}, {"lab", {0.0, 0.0, 0.0}}, {"hall", {2.0, 2.0, 0.0}}, {"rescue_1", {1.0, 7.5, 0.0}}};

/// Bounds of the scale errors per metre and per radian, drawn once a run; and the wheels' slip, m per square root of m.
struct Wheels {
  const char* name;
  double drift, slip;
};

const std::vector<Wheels> all_wheels{{"0.75 %", 0.0075, 0.002}, {"3 %", 0.03, 0.002}};

struct Options {
  int seeds = 20;
  int time = 300;  // s
  bool smoke = false;
  std::string place, plots;
};

struct Error {
  double position = 0.0;  // m
  double yaw = 0.0;       // rad
};

struct Drive {
  std::array<std::vector<Error>, methods> errors;  // once a second
  std::array<std::array<int, localization::outcomes>, methods> outcomes{};
  double way = 0.0;  // m
};

/// Drives straight on until something is near, and turns away from it until there is room again.
class Wanderer {
 public:
  explicit Wanderer(unsigned seed) : random_(seed) {}

  geometry::Twist2 steer(const sim::World& world, const Pose2& pose) {
    const double ahead = turn_ == 0.0 ? 0.45 : 0.8;
    if (world.nearest(pose.position() + ahead * geometry::heading(pose.yaw), 0.45)) {
      if (turn_ == 0.0) turn_ = random_() % 2 == 0 ? 0.7 : -0.7;
      return {0.0, turn_};
    }
    turn_ = 0.0;
    if (random_() % 20 == 0) bend_ = (static_cast<double>(random_() % 401) - 200.0) / 1000.0;
    return {0.5, bend_};
  }

 private:
  std::mt19937 random_;
  double turn_ = 0.0, bend_ = 0.0;
};

Error error_of(const Pose2& pose, const Pose2& truth) {
  return {(pose.position() - truth.position()).norm(), std::abs(geometry::angle_between(pose.yaw, truth.yaw))};
}

localization::LaserLocalizerParams mounted(const Pose2& mount) {
  localization::LaserLocalizerParams params;
  params.mount = mount;
  return params;
}

/// One robot, and what three localizers make of its wheels and its sensors. Frame odom begins at the robot's true
/// start, so that it is the frame map as long as nothing drifts.
class Run {
 public:
  Run(std::shared_ptr<const sim::World> world, const sim::RobotSetup& setup, unsigned seed)
      : world_(world),
        model_(setup.model),
        simulation_(std::move(world), {setup}, seed),
        wanderer_(seed),
        laser_(mounted(setup.model.laser->pose)),
        sonar_({}) {}

  Drive drive(int time) {
    constexpr auto step = 50ms;
    const Duration end = std::chrono::seconds(time);
    for (Pose2 before = robot().pose(); simulation_.now() <= end; before = robot().pose()) {
      localize();
      if (simulation_.now() % 1s == 0ms) note();
      simulation_.command(0, wanderer_.steer(*world_, robot().pose()));
      simulation_.step(step);
      drive_.way += (robot().pose().position() - before.position()).norm();
    }
    return std::move(drive_);
  }

  const localization::OdometryFilter& filter(Method method) const {
    return method == by_laser ? laser_.filter() : sonar_.filter();
  }

 private:
  const sim::Robot& robot() const { return simulation_.robots()[0]; }

  void localize() {
    const Pose2 odom = robot().odometry().pose;
    laser_.filter().odometry(Time(simulation_.now()), odom);
    sonar_.filter().odometry(Time(simulation_.now()), odom);
    if (robot().laser().stamp == simulation_.now()) {
      const sim::LaserMount& mount = *model_.laser;
      beams_.assign(robot().laser().ranges.begin(), robot().laser().ranges.end());
      count(by_laser, laser_.scan(odom, {-0.5 * mount.field_of_view, beam_spacing(mount), mount.min_range,
                                         mount.max_range, beams_}));
    }
    if (robot().sonar().stamp == simulation_.now()) {
      const sim::SonarRing& ring = model_.sonars;
      echoes_.clear();
      for (std::size_t i = 0; i < ring.poses.size(); ++i) echoes_.push_back({ring.poses[i], robot().sonar().ranges[i]});
      count(by_sonars, sonar_.round(odom, echoes_, {ring.min_range, ring.max_range}));
    }
  }

  void count(Method method, Outcome outcome) { ++drive_.outcomes[method][static_cast<std::size_t>(outcome)]; }

  void note() {
    drive_.errors[by_wheels].push_back(error_of(robot().odometry().pose, robot().pose()));
    for (const Method method : {by_laser, by_sonars})
      drive_.errors[method].push_back(error_of(filter(method).pose(), robot().pose()));
  }

  using Duration = sim::Duration;
  std::shared_ptr<const sim::World> world_;
  sim::RobotModel model_;
  sim::Simulation simulation_;
  Wanderer wanderer_;
  localization::LaserLocalizer laser_;
  localization::SonarLocalizer sonar_;
  std::vector<float> beams_;
  std::vector<localization::SonarEcho> echoes_;
  Drive drive_;
};

std::vector<Drive> drives(const Place& place, const Wheels& wheels, const Options& options) {
  const auto world = std::make_shared<const sim::World>(
      sim::load_world(KERVAN_SOURCES "/sim/worlds/" + std::string(place.name) + ".yaml"));
  sim::RobotSetup setup{
      .name = "r1", .model = sim::load_robot_model(KERVAN_SOURCES "/sim/robots/p3at.yaml"), .start = place.start};
  setup.odometry.drift = wheels.drift;
  setup.odometry.slip = wheels.slip;
  setup.odometry.resolution = setup.model.odometry.resolution;
  std::vector<Drive> result;
  for (int seed = 1; seed <= options.seeds; ++seed)
    result.push_back(Run(world, setup, static_cast<unsigned>(seed)).drive(options.time));
  return result;
}

struct Summary {
  double mean = 0.0, worst_mean = 0.0, worst = 0.0, end = 0.0;  // m
  double mean_yaw = 0.0, worst_yaw = 0.0;                       // rad
};

Summary summarize(const std::vector<Drive>& drives, std::size_t method) {
  Summary sum;
  const auto runs = static_cast<double>(drives.size());
  for (const Drive& drive : drives) {
    const std::vector<Error>& errors = drive.errors[method];
    const auto count = static_cast<double>(errors.size());
    double mean = 0.0;
    for (const Error& error : errors) {
      mean += error.position / count;
      sum.mean_yaw += error.yaw / count / runs;
      sum.worst = std::max(sum.worst, error.position);
      sum.worst_yaw = std::max(sum.worst_yaw, error.yaw);
    }
    sum.mean += mean / runs;
    sum.worst_mean = std::max(sum.worst_mean, mean);
    sum.end += errors.back().position / runs;
  }
  return sum;
}

void print(const Place& place, const Wheels& wheels, const std::vector<Drive>& drives) {
  constexpr double degrees = 180.0 / std::numbers::pi;
  for (std::size_t method = 0; method < methods; ++method) {
    const Summary s = summarize(drives, method);
    std::array<int, localization::outcomes> sum{};
    for (const Drive& drive : drives)
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += drive.outcomes[method][i];
    const auto of = [&](Outcome outcome) { return sum[static_cast<std::size_t>(outcome)]; };
    std::printf("| %s | %s | %s | %.3f | %.3f | %.3f | %.3f | %.2f | %.2f |", place.name, wheels.name, names[method],
                s.mean, s.worst_mean, s.worst, s.end, degrees * s.mean_yaw, degrees * s.worst_yaw);
    if (method != by_wheels)
      std::printf(" %d | %d | %d | %d | %d |\n", of(Outcome::matched), of(Outcome::line), of(Outcome::unknown),
                  of(Outcome::poor), of(Outcome::ambiguous));
    else
      std::printf(" | | | | |\n");
  }
  std::fflush(stdout);
}

/// Mean and worst position error of all drives, second by second.
ErrorCurve curve(const std::vector<Drive>& drives, std::size_t method) {
  ErrorCurve curve{names[method], {}, {}};
  for (std::size_t second = 0; second < drives.front().errors[method].size(); ++second) {
    double sum = 0.0, worst = 0.0;
    for (const Drive& drive : drives) {
      sum += drive.errors[method][second].position;
      worst = std::max(worst, drive.errors[method][second].position);
    }
    curve.mean.push_back(sum / static_cast<double>(drives.size()));
    curve.worst.push_back(worst);
  }
  return curve;
}

void plot(const Place& place, const Wheels& wheels, const std::vector<Drive>& drives, const std::string& folder) {
  save_error_plot(folder + "/scan_match_" + place.name + ".svg",
                  std::string(place.name) + ", drift " + wheels.name + ", " + std::to_string(drives.size()) +
                      " runs: position error, mean and worst (thin)",
                  {curve(drives, by_wheels), curve(drives, by_laser), curve(drives, by_sonars)});
}

/// Whether both sensors are as much better than dead reckoning as is asked, where that drifts much.
bool good_enough(const std::vector<Drive>& drives) {
  const double odometry = summarize(drives, by_wheels).mean;
  return summarize(drives, by_laser).mean <= 0.25 * odometry && summarize(drives, by_sonars).mean <= 0.75 * odometry;
}

bool table(const Options& options) {
  std::printf(
      "| place | drift | by | mean | mean of the worst run | worst | mean at the end | yaw, mean | yaw, worst | "
      "matched "
      "| along a line | map knows too little | poor | ambiguous |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  bool good = true;
  for (const Place& place : places) {
    if (!options.place.empty() && options.place != place.name) continue;
    for (const Wheels& wheels : all_wheels) {
      const std::vector<Drive> all = drives(place, wheels, options);
      print(place, wheels, all);
      if (&wheels != &all_wheels.back()) continue;
      good = (options.smoke || good_enough(all)) && good;
      if (!options.plots.empty()) plot(place, wheels, all, options.plots);
    }
  }
  return good;
}

}  // namespace
}  // namespace kervan::test

int main(int argc, char** argv) {
  using namespace kervan::test;
  Options options;
  std::vector<std::string> names;
  for (const Place& place : places) names.emplace_back(place.name);
  CLI::App app("How well a robot whose wheels err knows where it is.");
  app.add_flag("--smoke", options.smoke, "one short drive of each");
  app.add_option("--seeds", options.seeds)->check(CLI::PositiveNumber);
  app.add_option("--time", options.time, "of a drive, s")->check(CLI::PositiveNumber);
  app.add_option("--place", options.place)->check(CLI::IsMember(names));
  app.add_option("--plots", options.plots, "folder for a plot of each place")->check(CLI::ExistingDirectory);
  CLI11_PARSE(app, argc, argv)
  if (options.smoke) {
    options.seeds = 1;
    options.time = 20;
  }
  try {
    return table(options) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
