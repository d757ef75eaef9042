/// Wakes one waiting thread, from any thread and also under Cyclone's locks.
#pragma once

#include <condition_variable>
#include <mutex>
#include <utility>

#include "framework/component/time.hpp"

namespace kervan::runtime {

class Bell {
 public:
  void ring() noexcept {
    {
      const std::lock_guard lock(mutex_);
      rung_ = true;
    }
    rang_.notify_one();
  }

  /// Until it rings, at most this long; a ring that nobody has waited for yet counts. True if it rang.
  bool wait_for(Duration patience) {
    std::unique_lock lock(mutex_);
    rang_.wait_for(lock, patience, [this] { return rung_; });
    return std::exchange(rung_, false);
  }

 private:
  std::mutex mutex_;
  std::condition_variable rang_;
  bool rung_ = false;
};

}  // namespace kervan::runtime
