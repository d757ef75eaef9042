/// Whether a composition can run under the clock it asks for.
#pragma once

#include "deploy/composition/resolve.hpp"

namespace kervan::composition {

/// Adds to the findings; the ports must have their topics already.
void judge_clock(ResolvedComposition& resolved);

}  // namespace kervan::composition
