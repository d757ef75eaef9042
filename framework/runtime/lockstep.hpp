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
#include "framework/runtime/fences.hpp"

namespace kervan::workers {
class WorkerPool;
}

namespace kervan::runtime {

class Lockstep {
 public:
  /// Drives the components of `container`, which outlives this. `instant` is the container's time.
  Lockstep(Container& container, Instant& instant, unsigned threads);
  Lockstep(const Lockstep&) = delete;
  Lockstep& operator=(const Lockstep&) = delete;
  ~Lockstep();

  /// A sample has arrived at a port of the component. From any thread, also under Cyclone's locks.
  void arrived(ComponentInstance& instance) noexcept;
  /// Takes out of the next cycle who is no longer there, or never came to be.
  void forget_departed();

  /// Once all endpoints of the container exist: makes what keeps it in step with the composition's other containers, if
  /// there are any. Throws ConfigError or DdsError.
  void connect();
  /// Waits for the other containers; if the run cannot begin, says why.
  std::optional<RunReport> join(const RunControl& control);
  /// After activation: runs until one of the ends.
  RunReport run(const RunControl& control);
  /// Deactivates everybody, lets them hear each other's last words, and shuts them down.
  void end();

  /// Handles everything at the present time, then moves to `until`, handling every time on the way.
  void advance(Time until);

  std::uint64_t cycles() const { return cycles_; }  ///< run so far
  /// How this container's run ended apart from the others'; nothing if it did not.
  const std::optional<RunReport>& broken_off() const;
  /// By writer index, after the end of a run in several containers.
  std::vector<std::pair<unsigned, std::uint64_t>> traces_elsewhere() const;

 private:
  bool run_one_time(RunReport& report);
  void run_due();
  void run_inputs();
  void agree();
  bool together() const { return fences_ && !fences_->broken_off(); }
  std::string livelock() const;
  Time next_due() const;
  void for_each_parallel(const std::vector<ComponentInstance*>& instances,
                         const std::function<void(ComponentInstance&)>& work);

  Container& container_;
  Instant& instant_;
  std::unique_ptr<workers::WorkerPool> workers_;
  std::unique_ptr<Fences> fences_;  ///< only if there are other containers
  Time end_ = Time::max();          ///< when the time asked for is over
  Round round_;
  const std::atomic<bool>* stop_ = nullptr;
  std::uint64_t cycles_ = 0;
  std::atomic_flag ready_spin_ = ATOMIC_FLAG_INIT;
  std::vector<ComponentInstance*> ready_;  ///< under ready_spin_: those that have samples
  std::vector<ComponentInstance*> batch_;  ///< scratch of a cycle
  std::vector<bool> looping_;              ///< by component: it ran in one of the last cycles before the limit
};

}  // namespace kervan::runtime
