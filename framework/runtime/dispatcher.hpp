/// Drives components under the wall clock: runs those that have samples or a timer due, sleeps when nobody has.
#pragma once

#include <condition_variable>
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

  /// Runs components in the calling thread until stop(). Several threads may be in here; each component runs in one of
  /// them at a time.
  void run();
  void stop();

 private:
  struct Wake {
    Time due;
    ComponentInstance* instance;
  };

  ComponentInstance* next();
  void push(ComponentInstance& instance) noexcept;
  void release_due(Time now);
  void run_one(ComponentInstance& instance);

  std::mutex mutex_;
  std::condition_variable work_;
  ComponentInstance* first_ = nullptr;  ///< queue through ComponentInstance::next_queued
  ComponentInstance* last_ = nullptr;
  std::vector<Wake> wakes_;  ///< a heap, earliest on top; entries whose time was changed since are skipped
  int waiting_ = 0;
  bool stopped_ = false;
};

}  // namespace kervan::runtime
