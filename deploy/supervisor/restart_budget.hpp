/// When a container whose process ended is started again, and when no more.
#pragma once

#include <chrono>
#include <deque>
#include <optional>

#include "deploy/composition/composition.hpp"

namespace kervan::supervisor {

using SteadyTime = std::chrono::steady_clock::time_point;

/// The first restart comes after `backoff`, each further one after twice the time of the one before, `longest_backoff`
/// at most. A container that was active for a second begins at `backoff` again. There are no more than `max` restarts
/// within `window`.
class RestartBudget {
 public:
  explicit RestartBudget(composition::Restart limits) : limits_(limits) {}

  /// The process ended at `now`, after having been active for `active`. How long to wait before the next start; nothing
  /// if there have been too many.
  std::optional<Duration> spend(SteadyTime now, Duration active);

  /// Restarts within the window that ended with the last call of spend().
  int recent() const { return static_cast<int>(recent_.size()); }

  /// What went wrong has been removed: begin afresh.
  void forgive();

 private:
  composition::Restart limits_;
  std::deque<SteadyTime> recent_;
  Duration delay_{};  ///< the last one; zero before the first
};

}  // namespace kervan::supervisor
