#include "framework/runtime/lockstep.hpp"

#include <algorithm>
#include <stdexcept>

#include "framework/runtime/crash_context.hpp"
#include "framework/runtime/operations.hpp"
#include "framework/workers/worker_pool.hpp"

namespace kervan::runtime {

namespace {

/// More cycles than this at one time mean that ports publish to each other for ever.
constexpr unsigned kMaxCycles = 1000;

/// Whoever runs within so many cycles of the limit belongs to the loop.
constexpr unsigned kLongestLoop = 100;

}  // namespace

Lockstep::Lockstep(Container& container, Instant& instant, unsigned threads)
    : container_(container), instant_(instant) {
  if (threads > 1) workers_ = std::make_unique<workers::WorkerPool>(static_cast<int>(threads));
}

Lockstep::~Lockstep() = default;

void Lockstep::connect() {
  if (container_.spec().members.size() > 1) fences_ = std::make_unique<Fences>(container_);
}

std::optional<RunReport> Lockstep::join(const RunControl& control) {
  end_ = control.limit == forever ? Time::max() : Time{} + control.limit;
  return fences_ ? fences_->join(control, end_) : std::nullopt;
}

std::vector<std::pair<unsigned, std::uint64_t>> Lockstep::traces_elsewhere() const {
  return fences_ ? fences_->traces() : std::vector<std::pair<unsigned, std::uint64_t>>{};
}

const std::optional<RunReport>& Lockstep::broken_off() const {
  static const std::optional<RunReport> never;
  return fences_ ? fences_->broken_off() : never;
}

void Lockstep::arrived(ComponentInstance& instance) noexcept {
  if (instance.schedule.exchange(1, std::memory_order_acq_rel) != 0) return;
  while (ready_spin_.test_and_set(std::memory_order_acquire)) {
  }
  ready_.push_back(&instance);
  ready_spin_.clear(std::memory_order_release);
}

void Lockstep::forget_departed() {
  while (ready_spin_.test_and_set(std::memory_order_acquire)) {
  }
  std::erase_if(ready_, [&](const ComponentInstance* ready) {
    return std::ranges::none_of(container_.instances(), [&](const auto& instance) { return instance.get() == ready; });
  });
  ready_spin_.clear(std::memory_order_release);
}

Time Lockstep::next_due() const {
  Time due = Time::max();
  for (const auto& instance : container_.instances()) due = std::min(due, instance->next_due());
  return due;
}

void Lockstep::for_each_parallel(const std::vector<ComponentInstance*>& instances,
                                 const std::function<void(ComponentInstance&)>& work) {
  if (!workers_) {
    for (ComponentInstance* instance : instances) work(*instance);
    return;
  }
  workers_->for_each(instances.size(), 2, [&](std::size_t i) {
    thread_local const HandlerStack handler_stack;
    work(*instances[i]);
  });
}

/// Cycle 0: what was asked of the container, then deadlines and timers.
void Lockstep::run_due() {
  instant_.cycle = 0;
  looping_.clear();
  container_.operations().run_posted();
  batch_.clear();
  for (const auto& instance : container_.instances())
    if (instance->next_due() <= instant_.time) batch_.push_back(instance.get());
  if (batch_.empty()) return;
  ++cycles_;
  for_each_parallel(batch_, [this](ComponentInstance& instance) { instance.run_due(instant_); });
}

/// The next cycle: handles what was published in the one before.
void Lockstep::run_inputs() {
  while (ready_spin_.test_and_set(std::memory_order_acquire)) {
  }
  batch_.clear();
  batch_.swap(ready_);
  ready_spin_.clear(std::memory_order_release);
  ++instant_.cycle;
  ++cycles_;
  std::ranges::sort(batch_, {}, &ComponentInstance::index);
  // All are staged before any runs: a sample published in this cycle belongs to the next.
  for (ComponentInstance* instance : batch_) {
    instance->schedule.store(0, std::memory_order_release);
    instance->stage(instant_.time);
    if (instant_.cycle + kLongestLoop <= kMaxCycles) continue;
    if (instance->index() >= looping_.size()) looping_.resize(instance->index() + 1, false);
    looping_[instance->index()] = true;
  }
  for_each_parallel(batch_, [this](ComponentInstance& instance) { instance.run_inputs(instant_); });
}

/// Finds out what this cycle has brought, here and everywhere.
void Lockstep::agree() {
  round_ = {};
  if (together()) {
    round_.more = fences_->grew();
  } else {
    while (ready_spin_.test_and_set(std::memory_order_acquire)) {
    }
    round_.more = !ready_.empty();
    ready_spin_.clear(std::memory_order_release);
  }
  if (!round_.more) {
    round_.next = next_due();
    round_.stop = container_.finish_wish();
    if (!round_.stop && stop_ && stop_->load(std::memory_order_relaxed))
      round_.stop = StopWish{.end = RunEnd::interrupted, .component = 0, .reason = "interrupted"};
  }
  if (instant_.cycle >= kMaxCycles)
    for (unsigned component = 0; component < looping_.size(); ++component)
      if (looping_[component]) round_.loop.push_back(component);
  if (together()) fences_->exchange(instant_, round_);
}

std::string Lockstep::livelock() const {
  std::vector<unsigned> loop = round_.loop;
  std::ranges::sort(loop);
  std::string text = "components publish to each other for ever at one time";
  const char* separator = ": ";
  for (const unsigned component : loop) {
    const auto& known = container_.spec().components;
    const auto loaded = std::ranges::find(container_.instances(), component, &ComponentInstance::index);
    if (component >= known.size() && loaded == container_.instances().end()) continue;
    text += separator + (component < known.size() ? known[component].name : (*loaded)->name());
    separator = ", ";
  }
  return text;
}

/// Handles everything at the present time; false, with the report filled, if it never ends or the others are
/// not waited for any more.
bool Lockstep::run_one_time(RunReport& report) {
  run_due();
  for (agree();; agree()) {
    if (const auto& ended = broken_off()) {
      report = *ended;
      return false;
    }
    if (!round_.more) break;
    if (instant_.cycle >= kMaxCycles) {
      report.end = RunEnd::livelock;
      report.reason = livelock();
      return false;
    }
    run_inputs();
  }
  container_.publish_changed_statuses();
  return true;
}

void Lockstep::advance(Time until) {
  RunReport report;
  for (;;) {
    if (!run_one_time(report)) throw std::runtime_error(report.reason);
    if (round_.next > until) break;
    instant_ = {round_.next, 0};
  }
  instant_ = {until, 0};
}

RunReport Lockstep::run(const RunControl& control) {
  using Clock = std::chrono::steady_clock;
  RunReport report;
  stop_ = control.stop;
  Clock::time_point next_progress = Clock::now();
  for (unsigned steps = 0; run_one_time(report); ++steps) {
    if (round_.stop) {
      report.end = round_.stop->end;
      report.reason = round_.stop->reason;
      break;
    }
    if (control.progress && steps % 16 == 0 && Clock::now() >= next_progress) {
      control.progress(instant_.time);
      next_progress = Clock::now() + kProgressPeriod;
    }
    if (round_.next == Time::max()) {
      report.end = RunEnd::idle;
      report.reason = "no component has a timer, so nothing would ever happen again";
      break;
    }
    if (round_.next > end_) {
      instant_ = {end_, 0};
      report.end = RunEnd::time_limit;
      report.reason = "the time asked for has passed";
      break;
    }
    instant_ = {round_.next, 0};
  }
  return report;
}

void Lockstep::end() {
  // All have agreed to end, so nobody waits in vain any more unless somebody is lost.
  if (fences_) fences_->wait_whatever_happens();
  // Last words first, then everybody hears them, then nobody speaks any more.
  for (const auto& instance : container_.instances()) instance->deactivate(instant_);
  for (agree(); round_.more && instant_.cycle < kMaxCycles; agree()) run_inputs();
  for (const auto& instance : container_.instances()) instance->shutdown(instant_);
  container_.publish_changed_statuses();
  if (together()) fences_->leave(instant_);
}

}  // namespace kervan::runtime
