/// What a composition split over processes is measured against: the same processes written with Cyclone's C API and a
/// waitset, one participant each, on the loopback interface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace kervan::bench {

/// One process of a chain: takes from "chain<place - 1>" and writes to "chain<place>"; the first, at place 0, writes a
/// stamped message of 64 bytes every millisecond instead. Prints a line once it is matched with those before and after
/// it, and runs until the process is ended. `last`: nobody reads what it writes.
[[noreturn]] void raw_c_link(const std::string& tag, int place, bool last);

/// What a process that reads "chain0" in a waitset measures: nanoseconds from before the write to after the take.
std::vector<std::int64_t> raw_c_split_hops(const std::string& tag, std::size_t count);

}  // namespace kervan::bench
