/// The worlds of BARN (Perille, Truong, Xiao and Stone 2020, "Benchmarking Metric Ground Navigation",
/// doi:10.1109/SSRR50563.2020.9292572) as tables of cylinders.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/shapes.hpp"

namespace kervan::test {

struct BarnWorld {
  int number = 0;
  std::vector<sim::Circle> cylinders;
  std::vector<sim::Segment> walls;  ///< BARN has none
  geometry::Pose2 start;
  geometry::Vector2 goal;
  double optimal = 0.0;                  ///< m, length of the reference path
  std::optional<double> published = {};  ///< success rate of the published DWA baseline, if it has run here
};

/// The world of 24_barn.yaml, in the manner of BARN, number -1.
BarnWorld clutter_world();

/// The folder of the tables: barn/ in what KERVAN_TEST_DATA names, else in ../shared/data beside the project.
std::string barn_folder();

/// All worlds, in the order of the index; none if the folder is not there. Throws std::runtime_error, naming file and
/// line, if a table cannot be read.
std::vector<BarnWorld> barn_worlds(const std::string& folder);

}  // namespace kervan::test
