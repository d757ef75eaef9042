/// A plan of runs as its file says it: a composition, what is varied, what is looked at, and how it is shown. Nothing
/// in here knows how a run is made.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/component/time.hpp"
#include "framework/config/node.hpp"

namespace kervan::lab {

/// What one run is given, by the names of its nodes: an argument of the composition (`seed`), or a parameter of one of
/// its components (`r1/control.params.rho0`).
using Settings = std::vector<config::Node>;

/// One of the values of a factor.
struct Level {
  std::string label;  ///< "0.5 m", "pursuit"
  Settings settings;
};

/// Something that is varied.
struct Factor {
  std::string name;
  std::vector<Level> levels;  ///< at least one; their labels differ
  Location location;
};

/// A figure of a run's summary.json.
struct Response {
  std::string name;
  std::string figure;                  ///< dotted path: "robots.r1.time_s"
  std::string unit = {};               ///< for people; may be empty
  std::optional<std::string> is = {};  ///< the response is whether the figure is this text
  bool optional = false;               ///< runs may lack it
  Location location = {};              ///< of `figure`
};

/// By which factors runs are grouped, and which responses are shown of a group.
struct Table {
  std::vector<std::string> rows;
  std::vector<std::string> columns;
  std::vector<std::string> responses;
};

/// Every other level of `factor` beside the level `to`: differences of runs that are equal in all other factors.
struct Comparison {
  std::string factor;
  std::string to;
  std::vector<std::string> responses;
};

/// The paths of many runs in one picture of their world: one picture for each combination of the levels of `by`.
struct Overlay {
  std::vector<std::string> by;
  std::string colour;  ///< the factor that colours the paths; may be empty
  Location location;
};

struct Experiment {
  std::string name;
  std::string help;
  std::string file;                                 ///< as shown in messages
  std::filesystem::path folder;                     ///< of the file
  config::Node composition;                         ///< name or file
  std::optional<Duration> run_for;                  ///< limit on the composition's clock
  std::chrono::duration<double> wall_limit{600.0};  ///< longest wall time of one run
  Settings settings;                                ///< the same in every run
  std::vector<Factor> factors;  ///< in the file's order, which is that of the runs: the last one varies fastest
  std::vector<Response> responses;
  Table table;
  std::optional<Comparison> comparison;
  std::optional<Overlay> overlay;

  const Factor& factor(std::string_view name) const;      ///< must be there
  const Response& response(std::string_view name) const;  ///< must be there
};

/// One run of the plan.
struct Cell {
  std::vector<std::size_t> levels;  ///< one for each factor
  std::string name;                 ///< of its folder: "controller=potential_gecui,seed=1"; unlike that of any other
};

/// All combinations of all levels.
std::vector<Cell> cells(const Experiment& experiment);

/// What the experiment gives to this run, a value of a factor over one of all runs.
Settings settings_of(const Experiment& experiment, const Cell& cell);

/// "controller=potential_gecui, seed=1"
std::string describe(const Experiment& experiment, const Cell& cell);

}  // namespace kervan::lab
