/// What Kervan is measured against: Cyclone's C API used directly, and a bare queue between two threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kervan::bench {

/// One hop in the writer's thread: dds_write, and a listener that takes into its own sample. Nanoseconds each, from
/// before the write to the first line after the take.
std::vector<std::int64_t> raw_c_hops(std::size_t bytes, std::size_t count);

/// One hop to a thread that sleeps on a condition variable, one message per millisecond. Nanoseconds each.
std::vector<std::int64_t> queue_hops(std::size_t count);

/// The same through Cyclone: dds_write, a listener that wakes the sleeping thread, which takes. Nanoseconds each.
std::vector<std::int64_t> raw_c_cross_thread_hops(std::size_t count);

/// CPU seconds that `hops` writer-reader pairs in one waitset thread use for `seconds` at 1 kHz.
double raw_c_chain_cpu(int hops, double seconds);

}  // namespace kervan::bench
