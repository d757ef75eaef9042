/// Sonar readings and laser scans into maps, beside the textbook's way and MRPT's, in one run.
#include <time.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "components/mapping/laser_mapper.hpp"
#include "components/mapping/sonar_mapper.hpp"
#include "tests/bench/mapping_reference.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/statistics.hpp"

namespace {

using namespace kervan;
using bench::median;
using bench::say;
using geometry::Pose2;

/// Of this thread, so that others on the machine do not count.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// One way to do the work once for each pose; slow ones do less of it.
struct Method {
  std::string name;
  std::string target;  ///< least ratio to MRPT, or most time
  std::size_t share;   ///< it does one of so many poses
  std::function<void(const Pose2&)> insert;
};

std::vector<Pose2> random_poses(std::size_t count, double within) {
  std::mt19937 random(1);
  const auto number = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
  std::vector<Pose2> poses;
  for (std::size_t i = 0; i < count; ++i)
    poses.push_back({number(-within, within), number(-within, within), number(-std::numbers::pi, std::numbers::pi)});
  return poses;
}

/// Alternating rounds; one line for each method, with its ratio to the one before which `than` stands.
void compare(const std::vector<Method>& methods, const std::vector<Pose2>& poses, const std::string& than, int rounds,
             double per_second, const char* unit) {
  std::vector<std::vector<double>> times(methods.size());
  for (const Method& method : methods)  // first of all, tables are made and memory is touched
    for (std::size_t i = 0; i < poses.size(); i += method.share) method.insert(poses[i]);
  for (int round = 0; round < rounds; ++round)
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const double start = cpu_seconds();
      std::size_t done = 0;
      for (std::size_t i = 0; i < poses.size(); i += methods[m].share, ++done) methods[m].insert(poses[i]);
      times[m].push_back((cpu_seconds() - start) * per_second / static_cast<double>(done));
    }
  std::size_t reference = methods.size();
  for (std::size_t m = 0; m < methods.size(); ++m)
    if (methods[m].name == than) reference = m;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::vector<double> ratios;
    for (std::size_t round = 0; reference < methods.size() && round < times[m].size(); ++round)
      ratios.push_back(times[reference][round] / times[m][round]);
    say("| %s | %.1f %s | ", methods[m].name.c_str(), median(times[m]), unit);
    if (ratios.empty())
      say("- | %s |\n", methods[m].target.c_str());
    else
      say("%.2f | %s |\n", median(ratios), methods[m].target.c_str());
  }
}

void bench_sonar(double resolution, double aperture, double range, bool smoke) {
  using mapping::UpdateRule;
  mapping::SonarMapperParams params;
  params.resolution = resolution;
  params.model.half_aperture = 0.5 * aperture;
  const mapping::SonarLimits limits{0.15, 5.0};
  std::vector<Method> methods;
  auto textbook = bench::textbook_map(resolution, params.model);
  methods.push_back(
      {"textbook", "", smoke ? 100u : 200u, [&](const Pose2& pose) { textbook->sonar(pose, range, aperture); }});
  auto mrpt = bench::mrpt_map(resolution);
  if (mrpt) methods.push_back({"MRPT", "", 10, [&](const Pose2& pose) { mrpt->sonar(pose, range, aperture); }});
  const auto ours = [&](UpdateRule update, bool literal) {
    mapping::SonarMapperParams with = params;
    with.update = update;
    with.model.literal = literal;
    return mapping::SonarMapper(with);
  };
  mapping::SonarMapper bayes = ours(UpdateRule::bayes, false), literal = ours(UpdateRule::bayes, true),
                       masses = ours(UpdateRule::dempster_shafer, false), himm = ours(UpdateRule::himm, false);
  const auto add = [&](mapping::SonarMapper& mapper) {
    return [&mapper, &limits, range](const Pose2& pose) { mapper.add(pose, range, limits); };
  };
  const bool judged = aperture > 0.4 && range > 4.0;
  methods.push_back({"bayes", judged ? "4" : "", 1, add(bayes)});
  methods.push_back({"bayes, literal: the whole cone", judged ? "4" : "", 1, add(literal)});
  methods.push_back({"dempster_shafer", "", 1, add(masses)});
  methods.push_back({"himm", "150 ns at most", 1, add(himm)});
  say("\n%.0f cm, %.0f degrees, %.1f m:\n\n| | time | ratio to MRPT | wanted |\n|---|---|---|---|\n",
      100.0 * resolution, aperture * 180.0 / std::numbers::pi, range);
  compare(methods, random_poses(smoke ? 200 : 20000, 14.0), "MRPT", smoke ? 1 : 7, 1e9, "ns");
}

/// What a laser sees of a room of 12 x 8 m that it stands in the middle of, with posts: 5 m on the average.
std::vector<float> room() {
  std::vector<float> ranges;
  for (int i = 0; i <= 180; ++i) {
    const double angle = (i - 90) * std::numbers::pi / 180.0;
    const double x = 6.0 / std::max(1e-9, std::abs(std::cos(angle))),
                 y = 4.0 / std::max(1e-9, std::abs(std::sin(angle)));
    ranges.push_back(static_cast<float>(i % 40 < 3 ? 2.5 : std::min(x, y)));
  }
  return ranges;
}

void bench_laser(double resolution, bool smoke) {
  const std::vector<float> ranges = room();
  const geometry::Scan scan{-0.5 * std::numbers::pi, std::numbers::pi / 180.0, 0.05, 15.0, ranges};
  mapping::LaserMapper laser({.resolution = resolution});
  std::vector<Method> methods;
  auto textbook = bench::textbook_map(resolution, {});
  methods.push_back({"textbook", "", 10, [&](const Pose2& pose) { textbook->laser(pose, ranges); }});
  auto mrpt = bench::mrpt_map(resolution);
  if (mrpt) methods.push_back({"MRPT", "", 1, [&](const Pose2& pose) { mrpt->laser(pose, ranges); }});
  methods.push_back({"mapping/laser", "1", 1, [&](const Pose2& pose) { laser.add(pose, scan); }});
  double mean = 0.0;
  for (const float range : ranges) mean += static_cast<double>(range) / static_cast<double>(ranges.size());
  say("\n%.0f cm, 181 beams, %.1f m on the average:\n\n| | time | ratio to MRPT | wanted |\n|---|---|---|---|\n",
      100.0 * resolution, mean);
  compare(methods, random_poses(smoke ? 20 : 2000, 10.0), "MRPT", smoke ? 1 : 7, 1e6, "us");
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = bench::begin(argc, argv, "Mapping");
  say("\nRandom poses in 40 x 40 m, one thread, its CPU time; medians of alternating rounds. MRPT's cone has one value "
      "for "
      "all\nthat is free and one for what is occupied; ours has Murphy's. `bayes` leaves out what the model has "
      "nothing to "
      "say of.\n");
  if (!bench::mrpt_map(0.1)) say("\nBuilt without MRPT (package libmrpt-maps-dev): no ratios.\n");
  say("\n## A sonar reading\n");
  for (const double resolution : {0.05, 0.10})
    for (const double degrees : {15.0, 30.0})
      for (const double range : {1.0, 3.0, 4.9})
        bench_sonar(resolution, degrees * std::numbers::pi / 180.0, range, smoke);
  say("\n## A laser scan\n");
  for (const double resolution : {0.05, 0.10}) bench_laser(resolution, smoke);
  return bench::end();
}
