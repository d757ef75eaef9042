/// Times of a topic compared with how often its writers publish, as far as their timers tell.
#pragma once

#include "deploy/composition/resolve.hpp"

namespace kervan::composition {

/// Adds a finding for each writer whose shortest timer is too slow for the topic's deadline, lease or lifespan, or for
/// the largest age that a reader accepts. Each names the line of the timer's period and that of the topic's value. A
/// deadline or lease that must be missed, as the writer has no inputs that could make it publish, is an error; whatever
/// else leaves gaps is a warning.
void check_rates(ResolvedComposition& resolved, const ResolvedTopic& topic);

}  // namespace kervan::composition
