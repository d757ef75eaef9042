/// How tests wait: for a condition, never for a time.
#pragma once

#include <chrono>
#include <thread>

namespace kervan::test {

/// How long a test waits for something that is sure to come, however slow the machine is.
inline constexpr std::chrono::seconds kPatience{45};

/// Asks again and again until the answer is yes; false if it has not become so with all patience.
template <class Condition>
bool eventually(Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace kervan::test
