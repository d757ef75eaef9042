/// How good maps become: simulated sensors with noise, known poses, and the judgement of observe/map_quality.
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "components/mapping/laser_mapper.hpp"
#include "components/mapping/map_merger.hpp"
#include "components/mapping/sonar_mapper.hpp"
#include "components/observe/map_quality.hpp"
#include "sim/files/robot_file.hpp"
#include "sim/files/world_file.hpp"
#include "sim/laser.hpp"
#include "sim/sonar.hpp"
#include "tests/bench/maps.hpp"
#include "tests/bench/report.hpp"

namespace {

using namespace kervan;
using bench::say;
using geometry::Pose2;
using geometry::Vector2;

constexpr double resolution = 0.05;

observe::DrawnWorld drawn(const sim::World& world) {
  observe::DrawnWorld result;
  const auto add = [&](std::span<const sim::Segment> segments) {
    for (const auto& s : segments) result.walls.push_back({s.a, s.b});
  };
  add(world.segments());
  for (const auto& bitmap : world.bitmaps()) add(bitmap.edges().segments());
  for (const auto& c : world.circles()) result.circles.push_back({c.center, c.radius});
  for (const auto& box : world.boxes()) {
    observe::Polyline polygon;
    for (const Vector2& corner : corners(box)) polygon.push_back(corner);
    result.polygons.push_back(polygon);
  }
  return result;
}

/// A robot that drives straight on until something is near, and turns away from it: poses 5 cm or 10 degrees apart.
std::vector<Pose2> wander(const sim::World& world, Pose2 pose, std::size_t steps, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Pose2> way{pose};
  double turn = 0.0;
  while (way.size() < steps) {
    const Vector2 ahead = pose.position() + 0.25 * geometry::heading(pose.yaw);
    if (world.nearest(ahead, 0.4)) {
      if (turn == 0.0) turn = (random() % 2 ? 1.0 : -1.0) * geometry::radians(10.0);
      // Not always out of a corner by the same way.
      if (random() % 50 == 0) turn = -turn;
      pose.yaw = geometry::wrap_angle(pose.yaw + turn);
    } else {
      turn = 0.0;
      const Vector2 next = pose.position() + 0.05 * geometry::heading(pose.yaw);
      pose.x = next.x();
      pose.y = next.y();
      pose.yaw = geometry::wrap_angle(pose.yaw + geometry::radians(static_cast<double>(random() % 400) / 100.0 - 2.0));
    }
    way.push_back(pose);
  }
  return way;
}

struct Place {
  std::string name;
  std::string file;
  Pose2 start;
  std::size_t steps;
};

grid::Occupancy occupancy(const auto& mapper) {
  grid::Occupancy map(resolution, -1, std::size_t{1} << 30);
  const grid::CellBox box = mapper.box();
  if (box.empty()) return map;
  map.cover(box);
  std::vector<std::int8_t> row(static_cast<std::size_t>(box.columns));
  for (int y = box.y; y < box.y + box.rows; ++y) {
    mapper.read_percent({box.x, y, box.columns, 1}, row);
    std::copy(row.begin(), row.end(), map.place({box.x, y}));
  }
  return map;
}

class Survey {
 public:
  Survey(const Place& place, const std::string& sources)
      : world_(sim::load_world(place.file)),
        p3dx_(sim::load_robot_model(sources + "/sim/robots/p3dx.yaml")),
        p3at_(sim::load_robot_model(sources + "/sim/robots/p3at.yaml")),
        place_(place),
        way_(wander(world_, place.start, 2 * place.steps, 1)) {}

  mapping::SonarMapper by_sonar(const mapping::SonarMapperParams& params, std::optional<double> incidence,
                                std::span<const Pose2> way) const {
    sim::SonarSettings settings;
    settings.incidence_limit = incidence;
    sim::Sonars sonars(p3dx_.sonars, settings);
    const sim::RandomSource random(1, "r1");
    mapping::SonarMapper mapper(params);
    std::vector<double> ranges(sonars.size());
    for (std::size_t i = 0; i < way.size(); ++i) {
      sonars.measure(world_, way[i], random, i, ranges);
      for (std::size_t k = 0; k < ranges.size(); ++k)
        mapper.add(way[i] * p3dx_.sonars.poses[k], ranges[k], {p3dx_.sonars.min_range, p3dx_.sonars.max_range});
    }
    return mapper;
  }

  mapping::LaserMapper by_laser(const mapping::LaserMapperParams& params, std::span<const Pose2> way) const {
    const sim::LaserMount& mount = *p3at_.laser;
    const sim::Laser laser(mount, {});
    const sim::RandomSource random(1, "r1");
    mapping::LaserMapper mapper(params);
    std::vector<double> ranges(laser.size());
    std::vector<float> beams(laser.size());
    for (std::size_t i = 0; i < way.size(); ++i) {
      laser.measure(world_, way[i], random, i, ranges);
      std::copy(ranges.begin(), ranges.end(), beams.begin());
      mapper.add(way[i] * mount.pose,
                 {-0.5 * mount.field_of_view, beam_spacing(mount), mount.min_range, mount.max_range, beams});
    }
    return mapper;
  }

  std::span<const Pose2> first_half() const { return {way_.data(), place_.steps}; }
  std::span<const Pose2> second_half() const { return {way_.data() + place_.steps, place_.steps}; }
  std::span<const Pose2> whole() const { return way_; }

  void print(const std::string& what, const grid::Occupancy& map) {
    if (!truth_) {
      std::vector<Vector2> seeds;
      for (const Pose2& pose : way_) seeds.push_back(pose.position());
      truth_ = std::make_unique<observe::MapTruth>(drawn(world_), seeds, resolution);
    }
    const auto q = judge(map, *truth_);
    say("| %s | %s | %.2f | %.2f | %.2f | %.2f | %.1f | %.2f | %.3f / %.2f |\n", place_.name.c_str(), what.c_str(),
        100 * q.accuracy, 100 * q.near_accuracy, 100 * q.false_occupied, 100 * q.false_free, 100 * q.coverage,
        q.entropy_bits, q.wall_error_m, q.worst_wall_error_m);
  }

 private:
  sim::World world_;
  sim::RobotModel p3dx_, p3at_;
  Place place_;
  std::vector<Pose2> way_;
  std::unique_ptr<observe::MapTruth> truth_;
};

/// The tiles of a map, as a keeper gets them.
void send(const auto& mapper, mapping::MapMerger& merger, std::size_t source) {
  const grid::CellBox box = mapper.box();
  std::vector<std::int8_t> tile(std::size_t{grid::tile_side} * grid::tile_side);
  for (int y = box.y; y < box.y + box.rows; y += grid::tile_side)
    for (int x = box.x; x < box.x + box.columns; x += grid::tile_side) {
      mapper.read_percent({x, y, grid::tile_side, grid::tile_side}, tile);
      merger.add(source, {{grid::tile_of(x), grid::tile_of(y)}, 1, resolution, grid::tile_side, grid::tile_side, tile});
    }
}

void survey(const Place& place, const std::string& sources) {
  Survey survey(place, sources);
  using mapping::UpdateRule;
  const std::pair<const char*, UpdateRule> rules[] = {
      {"bayes", UpdateRule::bayes}, {"dempster_shafer", UpdateRule::dempster_shafer}, {"himm", UpdateRule::himm}};
  for (const auto& [name, rule] : rules) {
    mapping::SonarMapperParams params;
    params.update = rule;
    survey.print(std::string("sonar, ") + name, occupancy(survey.by_sonar(params, std::nullopt, survey.first_half())));
    survey.print(std::string("sonar, ") + name + ", 25 degrees",
                 occupancy(survey.by_sonar(params, geometry::radians(25.0), survey.first_half())));
    params.model.max_range = 2.0;
    survey.print(std::string("sonar, ") + name + ", 2 m",
                 occupancy(survey.by_sonar(params, std::nullopt, survey.first_half())));
    survey.print(std::string("sonar, ") + name + ", 2 m, 25 degrees",
                 occupancy(survey.by_sonar(params, geometry::radians(25.0), survey.first_half())));
  }
  survey.print("laser", occupancy(survey.by_laser({}, survey.first_half())));

  const auto first = survey.by_sonar({}, std::nullopt, survey.first_half());
  const auto second = survey.by_sonar({}, std::nullopt, survey.second_half());
  mapping::MapMerger merger({"r1", "r2"}, resolution, std::size_t{1} << 28);
  send(first, merger, 0);
  send(second, merger, 1);
  survey.print("sonar, bayes, two robots", occupancy(merger));
  survey.print("sonar, bayes, one for twice as long", occupancy(survey.by_sonar({}, std::nullopt, survey.whole())));
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = bench::begin(argc, argv, "Accuracy of maps");
  const std::string sources = KERVAN_SOURCES;
  std::vector<Place> places = {{"lab", sources + "/sim/worlds/lab.yaml", {2.0, 2.0, 0.0}, 3000},
                               {"hall", sources + "/sim/worlds/hall.yaml", {2.0, 2.0, 0.0}, 5000}};
  if (const auto file = bench::test_data("aria/columbia.map"))
    places.push_back({"columbia", *file, {0.0, 0.0, 0.0}, 6000});
  if (const auto file = bench::test_data("ros/tb3_sandbox.yaml"))
    places.push_back({"tb3_sandbox", *file, {-2.0, -0.5, 0.0}, 3000});
  say("\nCells of 5 cm, true poses, sonars of a P3-DX with 1 %% noise and 32 rays, laser of a P3-AT with 5 mm noise. "
      "Per cent; "
      "wall error in\nm, mean / worst. \"25 degrees\": smooth walls, met more obliquely than that they give no "
      "echo. \"2 m\": max_range.\n\n"
      "| place | map | accuracy | within one cell | false occupied | false free | coverage | entropy, bits | wall "
      "error "
      "|\n|---|---|---|---|---|---|---|---|---|\n");
  for (Place& place : places) {
    if (smoke) place.steps = 50;
    survey(place, sources);
    if (smoke) break;
  }
  return bench::end();
}
