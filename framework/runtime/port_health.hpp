/// How a port gets on with its peers: the watch finds out and writes, the status and tests read.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>

namespace kervan::runtime {

class PortHealth {
 public:
  /// A peer came, went or was refused; from any thread, also under Cyclone's locks.
  void mark_changed() noexcept { changed_.store(true, std::memory_order_release); }
  /// Whether that happened since the last call.
  bool take_changed() noexcept { return changed_.exchange(false, std::memory_order_acquire); }

  /// What is wrong with its peers now, one sentence each; empty while all is well.
  std::string trouble() const {
    const std::lock_guard lock(mutex_);
    return trouble_;
  }
  /// Samples of its peers that were no message of its type, so far.
  std::uint64_t undecodable() const { return undecodable_.load(std::memory_order_relaxed); }
  void add_undecodable(std::uint64_t count) { undecodable_.fetch_add(count, std::memory_order_relaxed); }

  /// True if that is news.
  bool set_trouble(std::string trouble) {
    const std::lock_guard lock(mutex_);
    if (trouble_ == trouble) return false;
    trouble_ = std::move(trouble);
    return true;
  }

 private:
  std::atomic<bool> changed_{true};
  std::atomic<std::uint64_t> undecodable_{0};
  mutable std::mutex mutex_;
  std::string trouble_;
};

}  // namespace kervan::runtime
