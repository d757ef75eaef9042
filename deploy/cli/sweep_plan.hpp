/// From the file of a sweep to commands that make its runs, every one of which was found to be good.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "deploy/lab/experiment.hpp"
#include "deploy/lab/runner.hpp"

namespace kervan::cli {

struct SweepPlan {
  lab::Experiment experiment;
  std::vector<lab::Cell> cells = {};
  std::vector<lab::Run> runs = {};       ///< one for each cell
  std::vector<std::string> worlds = {};  ///< of each cell: the file of its simulator's world; empty if it has none
};

/// Reads the file and resolves the composition once for each cell. Throws ConfigError for the first thing that cannot
/// be used, at its place in the sweep's file wherever that is what a person would edit.
SweepPlan plan_sweep(const std::string& name_or_file);

}  // namespace kervan::cli
