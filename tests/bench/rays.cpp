/// Rays over bitmaps and among segments, beside the textbook's walk from cell to cell, in one run; and how far their
/// results are from the exact ones.
#include <time.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "sim/cell_map.hpp"
#include "sim/files/ros_map.hpp"
#include "sim/files/world_file.hpp"
#include "tests/bench/maps.hpp"
#include "tests/bench/ray_reference.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/statistics.hpp"

namespace {

using namespace kervan;
using bench::median;
using bench::say;
using sim::Vector2;

constexpr int beams = 181;

/// Of this thread, so that others on the machine do not count.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Laser scans over half a circle from random free places, all arrays `beams` for each scan.
struct Scans {
  std::vector<Vector2> origins;
  std::vector<float> dx, dy;        // for the textbook's walk
  std::vector<Vector2> directions;  // the same

  sim::RayFan fan(std::size_t scan) const { return {origins[scan], {&directions[scan * beams], beams}}; }
};

Scans random_scans(std::size_t count, const Vector2& low, const Vector2& high,
                   const std::function<bool(const Vector2&)>& free) {
  Scans scans;
  std::mt19937 random(1);
  const auto number = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
  while (scans.origins.size() < count) {
    const Vector2 origin(number(low.x(), high.x()), number(low.y(), high.y()));
    if (!free(origin)) continue;
    scans.origins.push_back(origin);
    const double yaw = number(-std::numbers::pi, std::numbers::pi);
    for (int i = 0; i < beams; ++i) {
      const Vector2 direction = geometry::heading(yaw + (i - 90) * std::numbers::pi / 180.0);
      scans.dx.push_back(static_cast<float>(direction.x()));
      scans.dy.push_back(static_cast<float>(direction.y()));
      scans.directions.push_back(direction);
    }
  }
  return scans;
}

/// One way of casting all rays of the scans: fills distances in metres, infinity for nothing within the range.
struct Method {
  std::string name;
  std::string target;
  std::function<void(std::vector<float>&)> cast;
};

std::vector<Method> methods(const Scans& scans, const sim::Bitmap& bitmap, const bench::Raster& raster,
                            const sim::CellMap& cells, double range, bool with_targets) {
  std::vector<Method> all;
  all.push_back({"cell by cell", "-", [&, range](std::vector<float>& distances) {
                   const auto cell = static_cast<float>(bitmap.cell.x()), reach = static_cast<float>(range) / cell;
                   for (std::size_t scan = 0; scan < scans.origins.size(); ++scan) {
                     const Vector2 origin = (scans.origins[scan] - bitmap.origin.position()) / bitmap.cell.x();
                     for (std::size_t i = scan * beams; i < (scan + 1) * beams; ++i) {
                       const float d = walk(raster, static_cast<float>(origin.x()), static_cast<float>(origin.y()),
                                            scans.dx[i], scans.dy[i], reach);
                       distances[i] = d < reach ? d * cell : INFINITY;
                     }
                   }
                 }});
  const std::array<std::pair<sim::Instructions, std::pair<const char*, const char*>>, 3> widths{
      {{sim::Instructions::scalar, {"box skip, scalar", "6"}},
       {sim::Instructions::avx2, {"box skip, AVX2", "13"}},
       {sim::Instructions::avx512, {"box skip, AVX-512", "18"}}}};
  for (const auto& [instructions, texts] : widths) {
    if (!available(instructions)) continue;
    all.push_back({texts.first, with_targets ? texts.second : "-", [&, range, set = instructions](auto& distances) {
                     std::array<std::int32_t, beams> faces;
                     for (std::size_t scan = 0; scan < scans.origins.size(); ++scan) {
                       const sim::RayFan fan = scans.fan(scan);
                       cells.cast({&fan, 1}, range, {&distances[scan * beams], beams}, faces, set);
                     }
                   }});
  }
  return all;
}

double per_million_beyond(const std::vector<float>& found, const std::vector<float>& exact, float tolerance) {
  std::size_t off = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i] != exact[i] && !(std::abs(found[i] - exact[i]) <= tolerance)) ++off;
  return 1e6 * static_cast<double>(off) / static_cast<double>(found.size());
}

void bench_bitmap(const std::string& name, sim::Bitmap bitmap, bool with_targets, bool smoke) {
  // The textbook's walk needs a border that ends it.
  bench::Raster raster{bitmap.columns, bitmap.rows, bitmap.solid};
  for (int row = 0; row < bitmap.rows; ++row)
    for (int column = 0; column < bitmap.columns; ++column)
      if (row == 0 || column == 0 || row == bitmap.rows - 1 || column == bitmap.columns - 1)
        raster.solid[static_cast<std::size_t>(row) * static_cast<std::size_t>(bitmap.columns) +
                     static_cast<std::size_t>(column)] = 1;
  bitmap.solid = raster.solid;

  const double begin = cpu_seconds();
  const sim::SkipTables tables(bitmap.columns, bitmap.rows, bitmap.solid);
  const double tables_built = cpu_seconds();
  const sim::CellMap cells(bitmap);
  const double built = cpu_seconds();
  say("\n## %s, %d x %d cells of %.3f m\n\nTables built in %.1f ms, everything in %.1f ms.\n", name.c_str(),
      bitmap.columns, bitmap.rows, bitmap.cell.x(), 1e3 * (tables_built - begin), 1e3 * (built - tables_built));

  const double away = 6.0 * bitmap.cell.x();  // from everything
  const Vector2 low = bitmap.origin.position(),
                high = low + bitmap.cell.cwiseProduct(Vector2(bitmap.columns, bitmap.rows));
  const Scans scans = random_scans(smoke ? 20 : 3000, low, high, [&](const Vector2& point) {
    sim::NearestObstacle nearest;
    cells.edges().nearest(point, away, nearest);
    return !cells.solid_at(point) && nearest.distance > away;
  });
  std::vector<float> distances(scans.dx.size()), exact(scans.dx.size());
  for (const double range : {5.0, 8.0, 30.0}) {
    for (std::size_t i = 0; i < exact.size(); ++i) {
      sim::RayHit hit;
      // Not rounded: what a ray of double precision in the same direction meets.
      const Vector2 direction = Vector2(scans.dx[i], scans.dy[i]).normalized();
      cells.edges().cast({scans.origins[i / beams], direction}, range, hit);
      exact[i] = static_cast<float>(hit.distance);
    }
    const std::vector<Method> all = methods(scans, bitmap, raster, cells, range, with_targets && range == 8.0);
    std::vector<std::vector<double>> seconds(all.size()), ratios(all.size());
    std::vector<double> off(all.size());
    for (int round = 0; round < (smoke ? 1 : 7); ++round)
      for (std::size_t m = 0; m < all.size(); ++m) {
        const double start = cpu_seconds();
        all[m].cast(distances);
        seconds[m].push_back(cpu_seconds() - start);
        ratios[m].push_back(seconds[0].back() / seconds[m].back());
        off[m] = per_million_beyond(distances, exact, 0.01f);
      }
    say("\n%.0f m:\n\n| method | Mray/s | ratio | target | beyond 1 cm, of a million | allowed "
        "|\n|---|---|---|---|---|---|\n",
        range);
    for (std::size_t m = 0; m < all.size(); ++m)
      say("| %s | %.1f | %.1f | %s | %.1f | %s |\n", all[m].name.c_str(),
          1e-6 * static_cast<double>(exact.size()) / median(seconds[m]), median(ratios[m]), all[m].target.c_str(),
          off[m], m == 0 ? "-" : "20");
  }
}

void bench_segments(const std::string& name, const sim::World& world, bool smoke) {
  const sim::World shapes({.segments = {world.segments().begin(), world.segments().end()}});
  Vector2 low = Vector2::Constant(sim::infinity), high = -low;
  for (const sim::Segment& s : shapes.segments()) {
    low = low.cwiseMin(s.a.cwiseMin(s.b));
    high = high.cwiseMax(s.a.cwiseMax(s.b));
  }
  const Scans scans =
      random_scans(smoke ? 20 : 3000, low, high, [&](const Vector2& point) { return !shapes.nearest(point, 0.3); });
  std::vector<sim::RayHit> hits(scans.directions.size());
  std::vector<float> found(hits.size()), exact(hits.size());
  const double range = 8.0;
  std::vector<double> with_grid, with_all;
  for (int round = 0; round < (smoke ? 1 : 7); ++round) {
    double start = cpu_seconds();
    for (std::size_t scan = 0; scan < scans.origins.size(); ++scan) {
      const sim::RayFan fan = scans.fan(scan);
      shapes.cast({&fan, 1}, range, {&hits[scan * beams], beams});
    }
    with_grid.push_back(cpu_seconds() - start);
    start = cpu_seconds();
    for (std::size_t i = 0; i < hits.size(); ++i) {
      double nearest = sim::infinity;
      for (const sim::Segment& s : shapes.segments())
        nearest = std::min(nearest, sim::hit_distance({scans.origins[i / beams], scans.directions[i]}, s));
      exact[i] = static_cast<float>(nearest <= range ? nearest : sim::infinity);
    }
    with_all.push_back(cpu_seconds() - start);
  }
  for (std::size_t i = 0; i < hits.size(); ++i) found[i] = static_cast<float>(hits[i].distance);
  const double rays = 1e-6 * static_cast<double>(hits.size());
  say("\n## %s, %zu segments, 8 m\n\n| method | Mray/s | ratio | beyond 1 mm, of a million | allowed "
      "|\n|---|---|---|---|---|\n",
      name.c_str(), shapes.segments().size());
  say("| every segment | %.2f | 1.0 | - | - |\n", rays / median(with_all));
  say("| World::cast | %.2f | %.1f | %.1f | 50 |\n", rays / median(with_grid), median(with_all) / median(with_grid),
      per_million_beyond(found, exact, 0.001f));
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = bench::begin(argc, argv, "Rays");
  double load = 0.0;
  getloadavg(&load, 1);
  say("\n181-beam scans from random free places, one thread, its CPU time; medians of %d alternating rounds. The "
      "tables are\n"
      "four times as large as the textbook's raster, so the ratios shrink when others use the caches: at the start the "
      "load\n"
      "average was %.1f.\n",
      smoke ? 1 : 7, load);
  bench_bitmap(bench::cave_name(), bench::cave(50.0), true, smoke);
  if (const auto willow = bench::test_data("ros/willow-full-0.05.yaml"))
    bench_bitmap("Willow Garage", sim::load_ros_map(*willow), false, smoke);
  if (const auto columbia = bench::test_data("aria/columbia.map"))
    bench_segments("ARIA's columbia", sim::load_world(*columbia), smoke);
  return bench::end();
}
