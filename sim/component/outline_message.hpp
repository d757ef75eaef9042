/// The world as a message, for drawing.
#pragma once

#include <span>

#include "framework/component/time.hpp"
#include "kervan_msgs/msg/Outline.hpp"
#include "sim/moving_body.hpp"
#include "sim/world.hpp"

namespace kervan::sim {

/// The true shape of the world in the frame map, low obstacles included, moving ones not. Of bitmaps it holds the outer
/// edges.
kervan_msgs::msg::Outline outline_message(const World& world, Time stamp);

/// Moving obstacles where they are now, in their order, into `outline`, which keeps its memory.
void set_outlines(std::span<const MovingBody> bodies, Time stamp, kervan_msgs::msg::Outline& outline);

}  // namespace kervan::sim
