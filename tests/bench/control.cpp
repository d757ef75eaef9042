/// What a control cycle costs: the step of each control law, from what it sees to its twist, beside the same law
/// written as its formulas stand.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "components/control/dwa.hpp"
#include "components/control/seen_points.hpp"
#include "components/control/vff.hpp"
#include "components/control/vfh_openings.hpp"
#include "components/control/vfh_plus.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/statistics.hpp"

namespace {

using namespace kervan;
using bench::say;
using control::CertaintyWindow;
using control::PlacedScan;
using control::RobotState;
using geometry::Vector2;

constexpr double pi = std::numbers::pi;

bool smoke = false;
double sink = 0.0;  // what is not used might not be done

/// Time of one call of `work`(i), ns.
template <class Work>
double time_of(int steps, const Work& work) {
  const auto start = bench::now_ns();
  for (int i = 0; i < steps; ++i) sink += work(i);
  return static_cast<double>(bench::now_ns() - start) / steps;
}

/// Medians of alternating rounds of both.
struct Compared {
  double step = 0.0, textbook = 0.0;  // ns
};

template <class Step, class Textbook>
Compared compared(int steps, const Step& step, const Textbook& textbook) {
  const int rounds = smoke ? 3 : 51, calls = smoke ? 10 : steps;
  std::vector<double> step_ns, textbook_ns;
  for (int round = 0; round < rounds; ++round) {
    step_ns.push_back(time_of(calls, step));
    textbook_ns.push_back(time_of(std::max(1, calls / 20), textbook));
  }
  return {bench::median(step_ns), bench::median(textbook_ns)};
}

void row(const char* controller, const std::string& sees, const char* wanted, const Compared& times) {
  say("| %s | %s | %.2f us | %s | %.2f us | %.1f |\n", controller, sees.c_str(), times.step / 1e3, wanted,
      times.textbook / 1e3, times.textbook / times.step);
}

/// Eqs. 1 and 2 cell by cell.
Vector2 textbook_repulsion(const CertaintyWindow& window, const Vector2& robot, double f_cr) {
  Vector2 sum = Vector2::Zero();
  for (int row = 0; row < control::window_side; ++row)
    for (int column = 0; column < control::window_side; ++column) {
      const Vector2 cell = window.origin + window.resolution * Vector2(column + 0.5, row + 0.5);
      const double d = (robot - cell).norm();
      if (d < 0.5 * window.resolution) continue;
      const double certainty = window.cells[static_cast<std::size_t>(row * control::window_side + column)];
      sum += f_cr * certainty / (d * d) * (robot - cell) / d;
    }
  return sum;
}

grid::Grid<grid::Certainty> random_cells(double share) {
  grid::Grid<grid::Certainty> cells(0.1, {}, std::size_t{1} << 22);
  cells.cover({-128, -128, 256, 256});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> draw;
  for (int y = -128; y < 128; ++y)
    for (int x = -128; x < 128; ++x)
      for (int echoes = 0; draw(random) < share && echoes < 5; ++echoes) cells.place({x, y})->raise();
  return cells;
}

void bench_vff() {
  for (const double share : {0.0, 0.02, 0.5}) {
    const auto cells = random_cells(share);
    control::VirtualForceField field({});
    CertaintyWindow window;
    control::cut_window(cells, {0.05, 0.05}, window);
    const auto target = [](int i) { return Vector2(0.01 * (i % 1000) - 5.0, 0.02 * (i % 500) - 5.0); };
    const auto step = [&](int i) {
      return field.step({{0.05, 0.05, target(i).x()}, {0.5, 0.0}}, target(i), window).twist.angular;
    };
    const auto textbook = [&](int i) {
      return textbook_repulsion(window, Vector2(0.05, 0.05) + 1e-3 * target(i), 0.02).x();
    };
    const auto cut = [&](int i) {
      control::cut_window(cells, target(i), window);
      return static_cast<double>(window.cells[100]);
    };
    const std::string sees = std::to_string(std::lround(100.0 * share)) + " % of 33 x 33 cells with an echo";
    row("vff", sees, "0.3 us", compared(2000, step, textbook));
    row("vff, cutting the window out of the grid", sees, "", compared(2000, cut, cut));
  }
}

/// Scans on a drive along a room of 6 m x 4 m, turning all the time, among `posts` posts of 6 cm.
struct Drive {
  Drive(std::size_t beams, double field_of_view, int posts) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> x(0.5, 5.5), y(-1.5, 1.5);
    std::vector<Vector2> at;
    while (static_cast<int>(at.size()) < posts)
      if (const Vector2 post(x(random), y(random)); std::abs(post.y()) > 0.5) at.push_back(post);
    const double increment = field_of_view / static_cast<double>(beams - 1);
    for (int i = 0; i < 200; ++i) {
      const geometry::Pose2 robot{1.0 + 0.02 * i, 0.2 * std::sin(0.1 * i), 0.06 * i};
      auto& ranges = scans.emplace_back(beams);
      for (std::size_t beam = 0; beam < beams; ++beam) {
        const Vector2 ray = geometry::heading(robot.yaw - 0.5 * field_of_view + static_cast<double>(beam) * increment);
        ranges[beam] = static_cast<float>(range(robot.position(), ray, at));
      }
      poses.push_back(robot);
    }
    for (std::size_t i = 0; i < scans.size(); ++i)
      seen.push_back({poses[i], {-0.5 * field_of_view, increment, 0.05, 30.0, scans[i]}});
  }

  static double range(const Vector2& from, const Vector2& ray, const std::vector<Vector2>& posts) {
    double least = 30.0;
    if (ray.x() != 0.0) least = std::min(least, ((ray.x() > 0.0 ? 6.0 : 0.0) - from.x()) / ray.x());
    if (ray.y() != 0.0) least = std::min(least, ((ray.y() > 0.0 ? 2.0 : -2.0) - from.y()) / ray.y());
    for (const Vector2& post : posts) {
      const Vector2 way = post - from;
      const double along = way.dot(ray), off2 = way.squaredNorm() - along * along, rest2 = 0.06 * 0.06 - off2;
      if (along > 0.0 && rest2 > 0.0) least = std::min(least, along - std::sqrt(rest2));
    }
    return least;
  }

  RobotState robot(int i) const { return {poses[static_cast<std::size_t>(i) % poses.size()], {0.5, 0.0}}; }
  const PlacedScan& scan(int i) const { return seen[static_cast<std::size_t>(i) % seen.size()]; }

  std::vector<geometry::Pose2> poses;
  std::vector<std::vector<float>> scans;
  std::vector<PlacedScan> seen;
};

/// The histogram of VFH+ beam by beam: bearing, enlargement, and every sector that it blocks. Returns how many.
double textbook_histogram(const PlacedScan& seen, double radius, double block_within) {
  constexpr double width = 2.0 * pi / control::vfh_sectors;
  std::array<bool, control::vfh_sectors> blocked{};
  for (std::size_t i = 0; i < seen.scan.ranges.size(); ++i) {
    const double d = static_cast<double>(seen.scan.ranges[i]);
    if (!(d < block_within)) continue;
    const double beta = seen.laser.yaw + seen.scan.angle_min + static_cast<double>(i) * seen.scan.angle_increment;
    const double gamma = std::asin(std::min(1.0, radius / d));
    for (std::size_t sector = 0; sector < blocked.size(); ++sector)
      if (std::abs(std::remainder((static_cast<double>(sector) + 0.5) * width - beta, 2.0 * pi)) <= gamma)
        blocked[sector] = true;
  }
  return static_cast<double>(std::count(blocked.begin(), blocked.end(), true));
}

/// The dynamic window as printed: 20 x 20 pairs of speeds, each driven for 1.2 s in steps of 0.1 s, with the distance
/// to every point at each. Returns the turning rate of the best.
double textbook_window(const RobotState& robot, const Vector2& target, const std::vector<Vector2>& points) {
  double best = 0.0, best_score = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) {
      const double v = 1.2 * i / 19, w = 4.0 * j / 19 - 2.0;
      geometry::Pose2 pose = robot.pose;
      double clearance = std::numeric_limits<double>::infinity();
      for (int step = 0; step < 12; ++step) {
        pose = {pose.x + 0.1 * v * std::cos(pose.yaw), pose.y + 0.1 * v * std::sin(pose.yaw), pose.yaw + 0.1 * w};
        for (const Vector2& point : points) clearance = std::min(clearance, (point - pose.position()).norm());
      }
      const Vector2 way = target - pose.position();
      const double off = std::abs(std::remainder(std::atan2(way.y(), way.x()) - pose.yaw, 2.0 * pi));
      const double score = clearance < 0.33 ? -100.0 : 0.8 * (pi - off) + 0.1 * clearance + 0.1 * v;
      if (score <= best_score) continue;
      best_score = score;
      best = w;
    }
  return best;
}

/// A cycle: the scan among what was seen before, then a step.
void bench_dwa() {
  for (const int posts : {0, 12}) {
    const Drive drive(720, 1.5 * pi, posts);
    const Vector2 target(5.5, 0.0);
    control::SeenPoints seen({});
    control::DynamicWindow window({});
    std::vector<Vector2> points;
    int cycles = 0;
    const auto cycle = [&](int i) {
      seen.look(drive.scan(i).laser, drive.scan(i).scan, Time(std::chrono::milliseconds(50 * cycles++)));
      return window.step(drive.robot(i), target, seen.points()).twist.angular;
    };
    const auto textbook = [&](int i) {
      points.clear();
      for (const auto& point : seen.points()) points.push_back(point.at);
      return textbook_window(drive.robot(i), target, points);
    };
    row("dwa", std::string("720 over 270 degrees") + (posts > 0 ? ", a room of posts" : ", an empty room"), "200 us",
        compared(50, cycle, textbook));
  }
}

void bench_lasers() {
  struct Laser {
    const char* name;
    std::size_t beams;
    double field_of_view;
  };
  for (const Laser& laser : {Laser{"181 beams over 180 degrees", 181, pi}, {"720 over 270 degrees", 720, 1.5 * pi}})
    for (const int posts : {0, 12}) {
      const Drive drive(laser.beams, laser.field_of_view, posts);
      const std::string sees = std::string(laser.name) + (posts > 0 ? ", a room of posts" : ", an empty room");
      const Vector2 target(5.5, 0.0);
      control::VfhPlus plus({}, {});
      control::VfhOpenings openings({}, {});
      const auto histogram = [&](int i) { return textbook_histogram(drive.scan(i), 0.3525, 3.0); };
      row("vfh_plus", sees, laser.beams == 181 ? "5 us" : "",
          compared(
              400, [&](int i) { return plus.step(drive.robot(i), target, drive.scan(i)).twist.angular; }, histogram));
      row("vfh_openings", sees, "",
          compared(
              400, [&](int i) { return openings.step(drive.robot(i), target, drive.scan(i)).twist.angular; },
              histogram));
    }
}

}  // namespace

int main(int argc, char** argv) {
  smoke = bench::begin(argc, argv, "Control");
  say("\nA step of each law; medians of alternating rounds. The textbook of vff has eqs. 1 and 2 alone, cell by cell; "
      "that of the\nvfh the histogram of VFH+ alone, beam by beam and sector by sector; that of dwa 20 x 20 pairs of "
      "speeds for 1.2 s, each "
      "with the\ndistance to every point at every 0.1 s.\n\n"
      "| controller | sees | step | at most | textbook | ratio |\n|---|---|---|---|---|---|\n");
  bench_vff();
  bench_lasers();
  bench_dwa();
  if (std::isnan(sink)) say("not a number\n");
  return bench::end();
}
