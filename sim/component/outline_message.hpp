/// The world as a message, for drawing.
#pragma once

#include "framework/component/time.hpp"
#include "kervan_msgs/msg/Outline.hpp"
#include "sim/world.hpp"

namespace kervan::sim {

/// The true shape of the world in the frame map. Of bitmaps it holds the outer edges.
kervan_msgs::msg::Outline outline_message(const World& world, Time stamp);

}  // namespace kervan::sim
