/// Whether a composition can run under the clock it asks for.
#pragma once

#include "deploy/composition/resolve.hpp"

namespace kervan::composition {

/// Adds to the findings, and gives the clock's step to the component that simulates; the ports must have their topics
/// already.
void judge_clock(ResolvedComposition& resolved);

}  // namespace kervan::composition
