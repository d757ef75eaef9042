/// The maps that the benchmarks of the simulator run on.
#pragma once

#include <optional>
#include <string>

#include "sim/bitmap.hpp"

namespace kervan::bench {

/// A file of the folder that KERVAN_TEST_DATA names, else of ../shared/data beside the project; nothing without it.
std::optional<std::string> test_data(const std::string& file);

/// Stage's cave, each pixel twice as wide and high: 1000 x 1000 cells, `extent` metres wide and high, its lower left
/// corner at the origin. Without the file, discs of random places and sizes. The cells at the border are solid.
sim::Bitmap cave(double extent);

/// "Stage's cave", or what cave() is instead.
std::string cave_name();

}  // namespace kervan::bench
