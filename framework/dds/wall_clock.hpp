/// Wall time that a set clock never moves: the Unix time at the first call in this process, carried on by the steady clock.
#pragma once

#include "framework/component/time.hpp"

namespace kervan::dds {

Time wall_now();

}  // namespace kervan::dds
