/// Everything that is said about the runs of a plan, in files beside them.
#pragma once

#include <filesystem>
#include <functional>

#include "components/observe/map_drawing.hpp"
#include "deploy/lab/results.hpp"

namespace kervan::lab {

/// The world of a run of the plan, for the overlay.
using WorldOf = std::function<observe::DrawnWorld(std::size_t cell)>;

/// Writes into `folder`, whose runs are in `folder`/runs: runs.csv, table.csv, differences.csv, a bar chart for each
/// response (bars-NAME.svg), the overlays (paths-N.svg) and README.md, which shows them all. Equal results give equal
/// files. Throws ConfigError for a file that cannot be written.
void write_report(const Results& results, const std::filesystem::path& folder, const WorldOf& world_of);

}  // namespace kervan::lab
