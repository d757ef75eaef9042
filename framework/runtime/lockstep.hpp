/// Drives components in logical time: at time t, cycle d handles exactly what was published in cycle d-1, and when
/// there is nothing left time moves to the next timer. Order depends on the composition, never on threads, on processes
/// or on how fast anybody is.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/runtime/container.hpp"

namespace kervan::runtime {

class WorkerPool;

/// Why a run should end at the present time.
struct StopWish {
  RunEnd end = RunEnd::finished;  ///< finished or interrupted
  unsigned component = 0;         ///< finished: which one wants it
  std::string reason;
};

class Lockstep {
 public:
  /// Drives the components of `container`, which outlives this. `instant` is the container's time.
  Lockstep(Container& container, Instant& instant, unsigned threads);
  Lockstep(const Lockstep&) = delete;
  Lockstep& operator=(const Lockstep&) = delete;
  ~Lockstep();

  /// A sample has arrived at a port of the component. From any thread, also under Cyclone's locks.
  void arrived(ComponentInstance& instance) noexcept;

  /// After activation: runs until one of the ends.
  RunReport run(const RunControl& control);
  /// Deactivates everybody, lets them hear each other's last words, and shuts them down.
  void end();

  /// Handles everything at the present time, then moves to `until`, handling every time on the way.
  void advance(Time until);

  std::uint64_t cycles() const { return cycles_; }  ///< run so far

 private:
  /// What is known after a cycle.
  struct Round {
    bool more = false;        ///< something was published that somebody will hear
    Time next = Time::max();  ///< the earliest timer or deadline; only said if there is no more
    std::optional<StopWish> stop;
  };

  bool run_one_time(RunReport& report);
  void run_due();
  void run_inputs();
  void agree();
  void collect_batch();
  Time next_due() const;
  void for_each_parallel(const std::vector<ComponentInstance*>& instances,
                         const std::function<void(ComponentInstance&)>& work);

  Container& container_;
  Instant& instant_;
  std::unique_ptr<WorkerPool> workers_;
  Round round_;
  const std::atomic<bool>* stop_ = nullptr;
  std::uint64_t cycles_ = 0;
  std::atomic_flag ready_spin_ = ATOMIC_FLAG_INIT;
  std::vector<ComponentInstance*> ready_;  ///< under ready_spin_: those that have samples
  std::vector<ComponentInstance*> batch_;  ///< scratch of a cycle
  std::vector<bool> looping_;              ///< by component: it ran in one of the last cycles before the limit
};

}  // namespace kervan::runtime
