/// Drives components under the wall clock: runs those that have samples or a timer due, sleeps when nobody has.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "framework/component/time.hpp"

namespace kervan::runtime {

class ComponentInstance;

class Dispatcher {
 public:
  Dispatcher() = default;
  Dispatcher(const Dispatcher&) = delete;
  Dispatcher& operator=(const Dispatcher&) = delete;

  /// The component has something to do. From any thread, also under Cyclone's locks.
  void enqueue(ComponentInstance& instance) noexcept;
  /// Wakes the component at its next_due().
  void schedule(ComponentInstance& instance);

  /// Runs components in the calling thread until `ended` says so; it is asked at least every 50 ms, and after each
  /// component. Several threads may be in here; each component runs in one of them at a time.
  void run(const std::function<bool()>& ended);

 private:
  struct Wake {
    Time due;
    ComponentInstance* instance;
  };

  ComponentInstance* next(const std::function<bool()>& ended);
  void push(ComponentInstance& instance) noexcept;
  void release_due(Time now);
  void run_one(ComponentInstance& instance);

  std::mutex mutex_;
  std::condition_variable work_;
  ComponentInstance* first_ = nullptr;  ///< queue through ComponentInstance::next_queued
  ComponentInstance* last_ = nullptr;
  std::vector<Wake> wakes_;  ///< a heap, earliest on top; entries whose time was changed since are skipped
  int waiting_ = 0;
};

}  // namespace kervan::runtime
