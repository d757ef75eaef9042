/// A component in a container: its ports, its timers, and the rule that its handlers never run concurrently.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "framework/component/component.hpp"
#include "framework/runtime/outcome.hpp"
#include "framework/runtime/ports.hpp"
#include "framework/runtime/spec.hpp"

namespace kervan::runtime {

class Container;
class Dispatcher;

/// A component's place in its composition, and where its endpoints stand in the counting of all writers and of all
/// readers: at first_writer, first_writer + stride, …
struct Slot {
  unsigned index = 0;
  unsigned first_writer = 0;
  unsigned first_reader = 0;
  unsigned stride = 1;
};

class ComponentInstance {
 public:
  /// Constructs the component, then its endpoints. Throws what the component's constructor throws, or DdsError.
  ComponentInstance(Container& container, const ComponentSpec& spec, const ComponentClass& type, const Slot& slot);
  ~ComponentInstance();

  const std::string& name() const { return component_->name_; }
  const std::string& type() const { return type_; }
  const Component& component() const { return *component_; }
  unsigned index() const { return index_; }
  ComponentState state() const { return component_->state_; }
  const std::string& reason() const { return component_->reason_; }
  /// State and reason, for any thread.
  std::pair<ComponentState, std::string> status() const;
  bool running() const;  ///< active or degraded
  bool wants_own_thread() const { return component_->own_thread_; }
  const std::vector<std::unique_ptr<InputPort>>& inputs() const { return inputs_; }
  const std::vector<std::unique_ptr<OutputPort>>& outputs() const { return outputs_; }
  Container& container() { return container_; }
  spdlog::logger& log() const { return *log_; }
  const Instant& instant() const { return instant_; }

  /// How long a thread has been in it; 0 if none is. From any thread.
  Duration time_in_handler() const;

  void activate(Instant now);
  /// Last words; it runs on until shutdown() or stop().
  void deactivate(Instant now);
  /// Handles nothing any more until it is activated again.
  void stop(std::string why);
  /// Why the change was refused; nothing if all of it was made.
  std::optional<std::string> change_parameters(const ValueMap& changes, Instant now);
  /// What the component answers to a request that it declares.
  Outcome call(const RequestBase& request, const ValueMap& arguments, Instant now);
  const std::vector<RequestBase*>& requests() const { return component_->requests_; }
  const std::vector<ParameterInfo>& schema() const { return component_->schema_; }
  const ValueMap& values() const { return component_->values_; }  ///< those that were given, at first or later
  void shutdown(Instant now);

  /// The earliest timer or deadline; Time::max() if there is none or the component no longer runs.
  Time next_due() const;
  /// Deadlines first, then timers, in order of declaration.
  void run_due(Instant now);
  /// Moves arrived samples of all ready ports into their caches.
  void stage(Time now);
  /// Calls the handlers of all ports that have fresh samples, in order of declaration.
  void run_inputs(Instant now);

  /// Whether a status is to be published now: the state, its reason or a trouble changed, or a counter did and the last
  /// status is a second old.
  bool take_status_due(Time now);
  /// Of all inputs, as of the status published last; from any thread.
  Duration worst_latency() const { return Duration(worst_latency_.load(std::memory_order_relaxed)); }
  std::uint64_t missed_deadlines() const { return missed_deadlines_.load(std::memory_order_relaxed); }
  /// Something that its status tells has changed; from any thread.
  void touch_status() noexcept;

  // Scheduling under the wall clock; see Dispatcher.
  void notify() noexcept;
  std::atomic<Dispatcher*> dispatcher{nullptr};  ///< read by whichever thread a sample arrives in
  ComponentInstance* next_queued = nullptr;
  std::atomic<int> schedule{0};
  Time scheduled_for = Time::max();
  std::atomic<std::int64_t> entered{0};  ///< on the wall clock, since when a thread is in it; 0: none is

 private:
  friend class ::kervan::Component;

  /// Runs user code; what it throws fails this component alone.
  template <class Code>
  void guarded(const char* where, Instant now, Code&& code);
  void set_state(ComponentState state, std::string reason);

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
  std::atomic<Duration::rep> worst_latency_{0};
  std::atomic<std::uint64_t> missed_deadlines_{0};
  Time status_published_{};
  std::vector<PortCounters> counters_published_;  ///< of the inputs
  mutable std::mutex status_mutex_;  ///< for writing state and reason, and for reading them in another thread
};

}  // namespace kervan::runtime
