/// A component in a container: its ports, its timers, and the rule that its handlers never run concurrently.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "framework/component/component.hpp"
#include "framework/runtime/ports.hpp"
#include "framework/runtime/spec.hpp"

namespace kervan::runtime {

class Container;
class Dispatcher;

/// Where a component's endpoints begin in the composition's counting of all writers and of all readers.
struct FirstIndices {
  unsigned writer = 0;
  unsigned reader = 0;
};

class ComponentInstance {
 public:
  /// Constructs the component, then its endpoints. Throws what the component's constructor throws, or DdsError.
  ComponentInstance(Container& container, const ComponentSpec& spec, const ComponentClass& type, unsigned index,
                    FirstIndices first);
  ~ComponentInstance();

  const std::string& name() const { return component_->name_; }
  const std::string& type() const { return type_; }
  const Component& component() const { return *component_; }
  unsigned index() const { return index_; }
  ComponentState state() const { return component_->state_; }
  const std::string& reason() const { return component_->reason_; }
  bool wants_own_thread() const { return component_->own_thread_; }
  const std::vector<std::unique_ptr<InputPort>>& inputs() const { return inputs_; }
  const std::vector<std::unique_ptr<OutputPort>>& outputs() const { return outputs_; }
  Container& container() { return container_; }
  spdlog::logger& log() const { return *log_; }
  const Instant& instant() const { return instant_; }

  void activate(Instant now);
  void deactivate(Instant now);
  void shutdown(Instant now);

  /// The earliest timer or deadline; Time::max() if there is none or the component no longer runs.
  Time next_due() const;
  /// Deadlines first, then timers, in order of declaration.
  void run_due(Instant now);
  /// Moves arrived samples of all ready ports into their caches.
  void stage(Time now);
  /// Calls the handlers of all ports that have fresh samples, in order of declaration.
  void run_inputs(Instant now);

  /// True once after the state or its reason changed.
  bool take_status_changed() { return status_changed_.exchange(false); }

  // Scheduling under the wall clock; see Dispatcher.
  void notify() noexcept;
  std::atomic<Dispatcher*> dispatcher{nullptr};  ///< read by whichever thread a sample arrives in
  ComponentInstance* next_queued = nullptr;
  std::atomic<int> schedule{0};
  Time scheduled_for = Time::max();

 private:
  friend class ::kervan::Component;

  /// Runs user code; what it throws fails this component alone.
  template <class Code>
  void guarded(const char* where, Instant now, Code&& code);
  void set_state(ComponentState state, std::string reason);
  bool running() const;

  struct TimerState {
    const Timer* timer;
    Time due;
  };

  Container& container_;
  std::string type_;
  unsigned index_;
  Instant instant_;
  std::shared_ptr<spdlog::logger> log_;
  std::unique_ptr<Component> component_;
  std::vector<std::unique_ptr<OutputPort>> outputs_;
  std::vector<std::unique_ptr<InputPort>> inputs_;
  std::vector<TimerState> timers_;
  std::atomic<bool> status_changed_{false};
};

}  // namespace kervan::runtime
