/// The paths of many runs in pictures of their world.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/observe/map_drawing.hpp"
#include "deploy/lab/results.hpp"

namespace kervan::lab {

/// The paths of all robots of a run, as driven, in the order in which the table of the run names them; from
/// trajectory.csv in its folder. Empty if there is none.
std::vector<observe::Polyline> read_paths(const std::filesystem::path& run_folder);

/// One picture for this group of runs, in their world, coloured by the overlay's factor. `runs` is the folder that
/// holds the runs' folders. For an experiment with an overlay.
observe::MapDrawing overlay_of(const Results& results, const Group& group, const observe::DrawnWorld& world,
                               const std::filesystem::path& runs);

}  // namespace kervan::lab
