/// Drives components under the clocks wall and sim: runs those that have samples or a timer due, sleeps when nobody
/// has.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "framework/component/time.hpp"
#include "framework/runtime/clock.hpp"

namespace kervan::runtime {

class ComponentInstance;

/// How many components have something to do. Whoever runs simulated time moves it on when none has.
class Activity {
 public:
  /// `on_idle` is called by the thread in which the last of them came to rest; it must outlive the dispatchers.
  explicit Activity(std::function<void()> on_idle) : on_idle_(std::move(on_idle)) {}

  void begin() noexcept { busy_.fetch_add(1, std::memory_order_relaxed); }
  void end() {
    if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) on_idle_();
  }
  bool idle() const noexcept { return busy_.load(std::memory_order_acquire) == 0; }

 private:
  std::function<void()> on_idle_;
  std::atomic<int> busy_{0};
};

class Dispatcher {
 public:
  /// `activity` is for the container that runs simulated time; it counts the components of all its dispatchers.
  explicit Dispatcher(const ContainerClock& clock, Activity* activity = nullptr) : clock_(clock), activity_(activity) {}
  Dispatcher(const Dispatcher&) = delete;
  Dispatcher& operator=(const Dispatcher&) = delete;
  ~Dispatcher() { stop(); }

  /// The component has something to do. From any thread, also under Cyclone's locks.
  void enqueue(ComponentInstance& instance) noexcept;
  /// Wakes the component at its next_due().
  void schedule(ComponentInstance& instance);

  /// Simulated time has moved on: wakes whoever is due. From any thread, also under Cyclone's locks.
  void time_moved() noexcept;
  /// When the next component is due; Time::max() if none is.
  Time next_wake();

  /// Runs components in `threads` threads of its own; each component runs in one of them at a time.
  void start(unsigned threads);
  /// Returns when no thread is in a component any more.
  void stop();

  /// Waits until no thread is in the component, and keeps it so until release(). `give_up` is asked now and then; true
  /// ends the waiting, and the component is not held. From a thread that is none of the dispatcher's, one at a time.
  bool hold(ComponentInstance& instance, const std::function<bool()>& give_up);
  /// What came meanwhile is handled now.
  void release(ComponentInstance& instance);
  /// Forgets a component that is held, for good.
  void forget(ComponentInstance& instance);

 private:
  struct Wake {
    Time due;
    ComponentInstance* instance;
  };

  void run();
  ComponentInstance* next();
  bool unlink(ComponentInstance& instance);
  void tell_holder();
  void push(ComponentInstance& instance) noexcept;
  void release_due(Time now) noexcept;
  void run_one(ComponentInstance& instance);

  const ContainerClock& clock_;
  Activity* const activity_;
  std::mutex mutex_;
  std::condition_variable work_;
  ComponentInstance* first_ = nullptr;  ///< queue through ComponentInstance::next_queued
  ComponentInstance* last_ = nullptr;
  std::vector<Wake> wakes_;  ///< a heap, earliest on top; entries whose time was changed since are skipped
  int waiting_ = 0;
  bool stopped_ = false;
  std::atomic<ComponentInstance*> wanted_{nullptr};  ///< whom hold() waits for
  std::condition_variable at_rest_;
  std::vector<std::thread> threads_;
};

}  // namespace kervan::runtime
