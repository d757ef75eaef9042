/// Medians and percentiles, and the clock, of the benchmarks.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kervan::bench {

inline std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// The value below which `share` of the values lie; 0 without values.
template <class T>
T percentile(std::vector<T> values, double share) {
  if (values.empty()) return T{};
  const auto index = std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index), values.end());
  return values[index];
}

template <class T>
T median(std::vector<T> values) {
  return percentile(std::move(values), 0.5);
}

}  // namespace kervan::bench
