/// A world of the simulator as the drawing of a run's map wants it.
#pragma once

#include "components/observe/map_drawing.hpp"
#include "sim/world.hpp"

namespace kervan::cli {

/// What moves is drawn where it is at the start.
observe::DrawnWorld drawn(const sim::World& world);

/// What stands on the plan of a building: segments and pictures, not the discs and boxes that it is furnished with.
observe::DrawnWorld drawn_plan(const sim::World& world);

}  // namespace kervan::cli
