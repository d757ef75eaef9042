/// Counts what the whole program allocates, for tests of what must not allocate. Link allocations.cpp into the program.
#pragma once

#include <cstddef>

namespace kervan::test {

/// Calls of operator new so far, on all threads.
std::size_t allocations();

}  // namespace kervan::test
