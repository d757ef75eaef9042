/// Counters of the data path of this process. Tests and benchmarks assert with them that nothing was copied or serialised
/// that need not be, and that every refusal is seen.
#pragma once

#include <cstdint>

namespace kervan::dds {

struct DataPathStatistics {
  std::uint64_t serialised = 0;        ///< samples whose CDR was made, each at most once
  std::uint64_t deserialised = 0;      ///< samples decoded from CDR
  std::uint64_t refused = 0;           ///< received buffers that were not a valid message of their type
  std::uint64_t blocks_allocated = 0;  ///< sample blocks taken from the heap rather than from a pool
};

DataPathStatistics data_path_statistics();

}  // namespace kervan::dds
