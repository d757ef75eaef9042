#include "framework/runtime/dispatcher.hpp"

#include <algorithm>

#include "framework/dds/wall_clock.hpp"
#include "framework/runtime/container.hpp"
#include "framework/runtime/crash_context.hpp"
#include "framework/runtime/instance.hpp"

namespace kervan::runtime {

namespace {

// Values of ComponentInstance::schedule.
constexpr int kIdle = 0;     // nothing to do
constexpr int kQueued = 1;   // waits for a thread
constexpr int kRunning = 2;  // a thread is in it
constexpr int kAgain = 3;    // a thread is in it, and more has come since
constexpr int kHeld = 4;     // no thread may enter it

/// How often hold() asks whether to go on waiting.
constexpr auto kHoldSlice = std::chrono::milliseconds(20);

/// The dispatcher whose run() this thread is in: it looks at the queue again anyway and needs no waking.
thread_local const Dispatcher* current = nullptr;

}  // namespace

void Dispatcher::push(ComponentInstance& instance) noexcept {
  instance.next_queued = nullptr;
  if (last_)
    last_->next_queued = &instance;
  else
    first_ = &instance;
  last_ = &instance;
}

void Dispatcher::enqueue(ComponentInstance& instance) noexcept {
  int state = instance.schedule.load(std::memory_order_relaxed);
  for (;;) {
    // Whoever holds it queues it at the end, whether something came or not.
    if (state == kQueued || state == kAgain || state == kHeld) return;
    const int wanted = state == kIdle ? kQueued : kAgain;
    if (instance.schedule.compare_exchange_weak(state, wanted, std::memory_order_acq_rel)) break;
  }
  if (state == kRunning) return;  // whoever runs it will queue it again
  if (activity_) activity_->begin();
  bool wake;
  {
    const std::lock_guard lock(mutex_);
    push(instance);
    wake = waiting_ > 0;
  }
  if (wake) work_.notify_one();
}

void Dispatcher::schedule(ComponentInstance& instance) {
  const Time due = instance.next_due();
  if (due == instance.scheduled_for) return;
  instance.scheduled_for = due;
  if (due == Time::max()) return;
  bool earliest;
  {
    const std::lock_guard lock(mutex_);
    wakes_.push_back({due, &instance});
    std::push_heap(wakes_.begin(), wakes_.end(), [](const Wake& a, const Wake& b) { return a.due > b.due; });
    earliest = waiting_ > 0 && wakes_.front().instance == &instance;
  }
  if (earliest && current != this) work_.notify_one();
}

void Dispatcher::time_moved() noexcept {
  bool wake;
  {
    const std::lock_guard lock(mutex_);
    release_due(clock_.now());
    wake = first_ != nullptr && waiting_ > 0;
  }
  if (wake) work_.notify_one();
}

Time Dispatcher::next_wake() {
  const std::lock_guard lock(mutex_);
  return wakes_.empty() ? Time::max() : wakes_.front().due;
}

void Dispatcher::release_due(Time now) noexcept {
  while (!wakes_.empty() && wakes_.front().due <= now) {
    ComponentInstance& instance = *wakes_.front().instance;
    std::pop_heap(wakes_.begin(), wakes_.end(), [](const Wake& a, const Wake& b) { return a.due > b.due; });
    wakes_.pop_back();
    int state = kIdle;
    if (instance.schedule.compare_exchange_strong(state, kQueued, std::memory_order_acq_rel)) {
      if (activity_) activity_->begin();
      push(instance);
    } else if (state == kRunning) {
      instance.schedule.compare_exchange_strong(state, kAgain, std::memory_order_acq_rel);
    }
  }
}

/// The component whose turn it is; nullptr after stop().
ComponentInstance* Dispatcher::next() {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (stopped_) return nullptr;
    Duration sleep = forever;
    if (!wakes_.empty()) {
      const Time now = clock_.now();
      release_due(now);
      // Simulated time says by itself when it has moved.
      if (!wakes_.empty() && !clock_.stepped()) sleep = wakes_.front().due - now;
    }
    if (first_) {
      ComponentInstance* instance = first_;
      first_ = instance->next_queued;
      if (!first_) last_ = nullptr;
      // Somebody else must take the next one, or keep an eye on the timers, while this thread is busy.
      if ((first_ || !wakes_.empty()) && waiting_ > 0) work_.notify_one();
      return instance;
    }
    ++waiting_;
    // Arming a timer is not free, so the sleep has an end only if something is due.
    if (sleep == forever)
      work_.wait(lock);
    else
      work_.wait_for(lock, sleep);
    --waiting_;
  }
}

void Dispatcher::run_one(ComponentInstance& instance) {
  instance.schedule.store(kRunning, std::memory_order_release);
  const Time now = clock_.now();
  instance.entered.store((clock_.stepped() ? dds::wall_now() : now).time_since_epoch().count(),
                         std::memory_order_relaxed);
  instance.stage(now);  // first: what has arrived in time has not missed its deadline
  instance.run_due({now, 0});
  instance.run_inputs({now, 0});
  if (instance.take_status_due(now)) instance.container().publish_status(instance);
  schedule(instance);
  instance.entered.store(0, std::memory_order_relaxed);
  int state = kRunning;
  // Sequentially consistent, as hold() is: either this thread sees that somebody waits, or that one sees it at rest.
  if (instance.schedule.compare_exchange_strong(state, kIdle)) {
    if (activity_) activity_->end();
    if (wanted_.load() == &instance) tell_holder();
    return;
  }
  std::unique_lock lock(mutex_);
  if (wanted_.load() == &instance) {
    instance.schedule.store(kHeld);  // what it left over is handled when it is released
    at_rest_.notify_all();
    lock.unlock();
    if (activity_) activity_->end();
    return;
  }
  instance.schedule.store(kQueued, std::memory_order_release);
  push(instance);
}

void Dispatcher::tell_holder() {
  const std::lock_guard lock(mutex_);
  at_rest_.notify_all();
}

/// Takes the component out of the queue; false if it does not stand there.
bool Dispatcher::unlink(ComponentInstance& instance) {
  ComponentInstance* before = nullptr;
  for (ComponentInstance* at = first_; at; before = std::exchange(at, at->next_queued)) {
    if (at != &instance) continue;
    (before ? before->next_queued : first_) = at->next_queued;
    if (last_ == at) last_ = before;
    return true;
  }
  return false;
}

bool Dispatcher::hold(ComponentInstance& instance, const std::function<bool()>& give_up) {
  std::unique_lock lock(mutex_);
  wanted_ = &instance;
  bool held = false, unlinked = false;
  for (;;) {
    int state = kIdle;
    held = instance.schedule.compare_exchange_strong(state, kHeld) || state == kHeld;
    if (!held && state == kQueued && unlink(instance)) {
      instance.schedule.store(kHeld);
      held = unlinked = true;
    }
    if (held || give_up()) break;
    at_rest_.wait_for(lock, kHoldSlice);
  }
  wanted_ = nullptr;
  lock.unlock();
  if (unlinked && activity_) activity_->end();
  return held;
}

void Dispatcher::release(ComponentInstance& instance) {
  instance.schedule.store(kIdle);
  enqueue(instance);
}

void Dispatcher::forget(ComponentInstance& instance) {
  const std::lock_guard lock(mutex_);
  std::erase_if(wakes_, [&](const Wake& wake) { return wake.instance == &instance; });
  std::make_heap(wakes_.begin(), wakes_.end(), [](const Wake& a, const Wake& b) { return a.due > b.due; });
}

void Dispatcher::start(unsigned threads) {
  for (unsigned i = 0; i < threads; ++i) threads_.emplace_back(&Dispatcher::run, this);
}

void Dispatcher::run() {
  const HandlerStack handler_stack;
  const Dispatcher* outer = std::exchange(current, this);
  while (ComponentInstance* instance = next()) run_one(*instance);
  current = outer;
}

void Dispatcher::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  work_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

}  // namespace kervan::runtime
