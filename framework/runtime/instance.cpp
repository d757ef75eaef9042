#include "framework/runtime/instance.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>

#include "framework/component/error.hpp"
#include "framework/dds/wall_clock.hpp"
#include "framework/runtime/container.hpp"
#include "framework/runtime/crash_context.hpp"
#include "framework/runtime/dispatcher.hpp"
#include "framework/runtime/log.hpp"

namespace kervan::runtime {

namespace {

/// Counters are told at most this often.
constexpr Duration kStatusPeriod = std::chrono::seconds(1);

/// The composition's binding of a port, or the one its declaration implies.
PortBinding binding_of(const ComponentSpec& spec, const PortInfo& port) {
  for (const PortBinding& binding : spec.ports)
    if (binding.port == port.name) return binding;
  return {port.name, port.name.starts_with('/') ? port.name : "/" + port.name,
          builtin_profile(port.qos.profile()).value()};
}

}  // namespace

ComponentInstance::ComponentInstance(Container& container, const ComponentSpec& spec, const ComponentClass& type,
                                     const Slot& slot)
    : container_(container), type_(type.type), index_(slot.index), log_(container.make_logger(spec)) {
  ComponentSetup setup;
  setup.name = spec.name;
  setup.parameters = &spec.parameters;
  setup.run_folder = container.spec().run_folder;
  {
    const RunningCode code(spec.name.c_str(), "its constructor", container.now());
    component_ = construct(type, setup);
  }
  const ClockMode clock = container.spec().clock;
  for (OutputBase* output : component_->outputs_)
    outputs_.push_back(
        std::make_unique<OutputPort>(*output, binding_of(spec, output->info()), *this, container.domain(), clock,
                                     slot.first_writer + slot.stride * static_cast<unsigned>(outputs_.size())));
  for (InputBase* input : component_->inputs_)
    inputs_.push_back(
        std::make_unique<InputPort>(*input, binding_of(spec, input->info()), *this, container.domain(), clock,
                                    slot.first_reader + slot.stride * static_cast<unsigned>(inputs_.size())));
  component_->instance_ = this;
}

ComponentInstance::~ComponentInstance() {
  // Endpoints go first: after that no sample can arrive at a component that is being destroyed.
  inputs_.clear();
  outputs_.clear();
  const std::string name = component_ ? component_->name_ : "";
  const RunningCode code(name.c_str(), "its destructor", instant_.time);
  component_.reset();
}

bool ComponentInstance::running() const {
  return component_->state_ == ComponentState::active || component_->state_ == ComponentState::degraded;
}

void ComponentInstance::set_state(ComponentState state, std::string reason) {
  if (component_->state_ == state && component_->reason_ == reason) return;
  {
    const std::lock_guard lock(status_mutex_);
    component_->state_ = state;
    component_->reason_ = std::move(reason);
  }
  status_changed_ = true;
  if (state == ComponentState::degraded)
    log_->warn("degraded: {}", component_->reason_);
  else if (state == ComponentState::failed)
    log_->error("failed: {}", component_->reason_);
  else
    log_->debug("{}", to_text(state));
}

template <class Code>
void ComponentInstance::guarded(const char* where, Instant now, Code&& code) {
  instant_ = now;
  const LogTime log_time(now.time);
  const RunningCode running_code(component_->name_.c_str(), where, now.time);
  try {
    code();
  } catch (const std::exception& error) {
    set_state(ComponentState::failed, std::string(error.what()) + " (in " + where + ")");
  } catch (...) {
    set_state(ComponentState::failed, std::string("something that is no std::exception was thrown in ") + where);
  }
}

void ComponentInstance::activate(Instant now) {
  timers_.clear();
  for (const Timer* timer : component_->timers_) timers_.push_back({timer, now.time});
  for (const auto& input : inputs_) input->cache().restart_deadlines(now.time);
  set_state(ComponentState::active, {});
  guarded("on_activate", now, [&] { component_->on_activate(now.time); });
}

void ComponentInstance::deactivate(Instant now) {
  if (!running()) return;
  guarded("on_deactivate", now, [&] { component_->on_deactivate(now.time); });
}

std::pair<ComponentState, std::string> ComponentInstance::status() const {
  const std::lock_guard lock(status_mutex_);
  return {component_->state_, component_->reason_};
}

Duration ComponentInstance::time_in_handler() const {
  const std::int64_t since = entered.load(std::memory_order_relaxed);
  return since == 0 ? Duration::zero() : dds::wall_now().time_since_epoch() - Duration(since);
}

void ComponentInstance::stop(std::string why) {
  if (state() != ComponentState::failed) set_state(ComponentState::stopped, std::move(why));
}

std::optional<std::string> ComponentInstance::change_parameters(const ValueMap& changes, Instant now) {
  std::optional<std::string> refused;
  guarded("on_parameters_changed", now, [&] {
    try {
      component_->change_parameters(changes);
    } catch (const ParameterError& error) {
      refused = error.what();
    }
  });
  if (!refused && state() == ComponentState::failed) return "it failed: " + reason();
  return refused;
}

Outcome ComponentInstance::call(const RequestBase& request, const ValueMap& arguments, Instant now) {
  Outcome outcome;
  guarded("a request", now, [&] {
    try {
      outcome = {true, request.answer(arguments, now.time)};
    } catch (const ParameterError& error) {
      outcome.reason = error.what();
    } catch (const RequestRefused& refused) {
      outcome.reason = refused.what();
    }
  });
  if (state() == ComponentState::failed) return {false, "it failed: " + reason()};
  return outcome;
}

void ComponentInstance::shutdown(Instant now) {
  const bool was_running = running();
  guarded("on_shutdown", now, [&] { component_->on_shutdown(now.time); });
  if (was_running && running()) set_state(ComponentState::stopped, {});
}

Time ComponentInstance::next_due() const {
  Time due = Time::max();
  if (!running()) return due;
  for (const auto& input : inputs_) due = std::min(due, input->cache().next_deadline());
  for (const TimerState& timer : timers_) due = std::min(due, timer.due);
  return due;
}

void ComponentInstance::run_due(Instant now) {
  if (!running()) return;
  for (const auto& input : inputs_)
    if (input->cache().next_deadline() <= now.time) input->cache().check_deadlines(now.time);
  for (TimerState& timer : timers_) {
    if (timer.due > now.time || !running()) continue;
    const Duration period = timer.timer->period();
    timer.due += period;
    // Periods that passed while the component was held up are skipped, not made up for in a burst.
    if (timer.due <= now.time) timer.due += (now.time - timer.due) / period * period + period;
    guarded("a timer", now, [&] { timer.timer->fire(now.time); });
  }
}

void ComponentInstance::stage(Time now) {
  for (const auto& input : inputs_)
    if (input->take_ready()) input->stage(now);
}

void ComponentInstance::run_inputs(Instant now) {
  for (const auto& input : inputs_) {
    if (!running()) return;
    if (input->has_handler() && input->cache().has_fresh())
      guarded(input->binding().port.c_str(), now, [&] { input->deliver(now.time); });
  }
}

bool ComponentInstance::take_status_due(Time now) {
  if (!status_changed_.exchange(false)) {
    if (now - status_published_ < kStatusPeriod) return false;
    const bool counted =
        !std::ranges::equal(inputs_, counters_published_, {}, [](const auto& i) { return i->counters(); });
    if (!counted) return false;
  }
  status_published_ = now;
  counters_published_.clear();
  Duration worst_latency{};
  std::uint64_t missed_deadlines = 0;
  for (const auto& input : inputs_) {
    const PortCounters& counters = counters_published_.emplace_back(input->counters());
    worst_latency = std::max(worst_latency, counters.worst_latency);
    missed_deadlines += counters.deadline_missed;
  }
  worst_latency_.store(worst_latency.count(), std::memory_order_relaxed);
  missed_deadlines_.store(missed_deadlines, std::memory_order_relaxed);
  return true;
}

void ComponentInstance::touch_status() noexcept {
  status_changed_ = true;
  notify();
}

void ComponentInstance::notify() noexcept {
  if (Dispatcher* const target = dispatcher.load(std::memory_order_acquire)) target->enqueue(*this);
}

}  // namespace kervan::runtime
