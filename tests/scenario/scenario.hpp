/// A scenario as its file says it; README.md shows one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "framework/geometry/pose2.hpp"

namespace kervan::test {

struct Bounds {
  double least = 0.0;
  double most = 0.0;
};

/// The least distance of all rows of trajectory.csv to a point.
struct ClosestApproach {
  geometry::Vector2 to = geometry::Vector2::Zero();
  Bounds range;
};

struct RobotExpectation {
  std::optional<bool> reached;
  std::map<std::string, Bounds> figures;  ///< by their names in summary.json
  std::optional<ClosestApproach> closest;
};

struct Scenario {
  std::string name;  ///< of its file
  std::string help;
  std::string composition;             ///< a shipped one, or an absolute path
  bool place_all = false;              ///< in one container, whatever the composition says
  std::string length;                  ///< "170s", of a composition without a mission; else empty
  std::vector<std::string> arguments;  ///< "controller=potential_gecui"
  std::optional<std::int64_t> first_seed, last_seed;
  std::string result;
  int exit_code = 0;
  std::map<std::string, RobotExpectation> robots;
  std::map<std::string, std::map<std::string, Bounds>> figures;  ///< of components, as summary.json has them
  std::vector<std::string> warnings;                             ///< parts of those that the console may show
};

/// Throws ConfigError for anything that a scenario cannot hold.
Scenario load_scenario(const std::filesystem::path& file);

/// The files of the folder, sorted by name.
std::vector<std::filesystem::path> scenario_files(const std::filesystem::path& folder);

}  // namespace kervan::test
