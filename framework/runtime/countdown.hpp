/// What one thread waits for: a number of things that happen in other threads, also under Cyclone's locks. Nobody is
/// woken before the last of them, and no system call is made unless somebody sleeps.
#pragma once

#include <atomic>
#include <cstdint>

namespace kervan::runtime {

class Countdown {
 public:
  /// So many more things have to happen.
  void add(int things) noexcept { left_.fetch_add(things, std::memory_order_relaxed); }

  /// One of them has.
  void done() noexcept {
    if (left_.fetch_sub(1, std::memory_order_acq_rel) == 1) wake();
  }

  /// Makes wait() ask `give_up` again.
  void wake() noexcept {
    wakes_.fetch_add(1, std::memory_order_release);
    wakes_.notify_one();
  }

  /// Until everything has happened: true. Or until give_up(), asked before each sleep, says so: false.
  template <class GiveUp>
  bool wait(GiveUp&& give_up) {
    for (;;) {
      const std::uint32_t wakes = wakes_.load(std::memory_order_acquire);
      if (left_.load(std::memory_order_acquire) == 0) return true;
      if (give_up()) return false;
      wakes_.wait(wakes, std::memory_order_acquire);
    }
  }

 private:
  std::atomic<int> left_{0};
  std::atomic<std::uint32_t> wakes_{0};  ///< 32 bits, so that the kernel can wait on it directly
};

}  // namespace kervan::runtime
