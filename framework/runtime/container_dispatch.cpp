// How a container runs under the clocks wall and sim: dispatchers in threads of their own, and the thread that called
// run() watches over them and, in the container that runs simulated time, moves it on.
#include <algorithm>

#include "framework/runtime/clock_reader.hpp"
#include "framework/runtime/container.hpp"
#include "framework/runtime/dispatcher.hpp"
#include "framework/runtime/fences.hpp"
#include "framework/runtime/operations.hpp"
#include "framework/runtime/pace.hpp"

namespace kervan::runtime {

namespace {

using Steady = std::chrono::steady_clock;

/// For the first time on /clock: its writer waits for everybody else before it starts.
constexpr Duration kFirstClockPatience = std::chrono::seconds(10);

bool stop_wanted(const RunControl& control) { return control.stop && control.stop->load(std::memory_order_relaxed); }

RunReport interrupted() { return {.end = RunEnd::interrupted, .reason = "interrupted"}; }
RunReport clock_lost(const ContainerSpec& spec, Duration silence) {
  std::string reason = "/clock stands still: nothing came";
  if (const auto writer = clock_writer(spec))
    reason += " from " + writer->component + " in container " + writer->container;
  return {
      .end = RunEnd::clock_lost,
      .reason = reason + " for " + std::to_string(std::chrono::round<std::chrono::seconds>(silence).count()) + " s"};
}

RunReport time_limit() { return {.end = RunEnd::time_limit, .reason = "the time asked for has passed"}; }

}  // namespace

void Container::start_dispatchers(Activity* activity) {
  dispatchers_.clear();
  activity_ = activity;
  dispatchers_.push_back(std::make_unique<Dispatcher>(clock_, activity));
  for (const auto& instance : instances_) attach(*instance);
  dispatchers_.front()->start(spec_.threads);
  tell_dispatchers_the_time();
}

/// From now on, whenever another container moves the time.
void Container::tell_dispatchers_the_time() {
  if (!clock_reader_ || dispatchers_.empty()) return;
  clock_reader_->on_move([this] {
    for (const auto& dispatcher : dispatchers_) dispatcher->time_moved();
  });
}

void Container::attach(ComponentInstance& instance) {
  if (dispatchers_.empty()) return;
  Dispatcher* dispatcher = dispatchers_.front().get();
  if (instance.wants_own_thread()) {
    if (clock_reader_) clock_reader_->on_move({});
    dispatcher = dispatchers_.emplace_back(std::make_unique<Dispatcher>(clock_, activity_)).get();
    dispatcher->start(1);
    tell_dispatchers_the_time();
  }
  instance.dispatcher = dispatcher;
  dispatcher->enqueue(instance);  // whatever came before
}

/// The component that it served, if it is a component's own, is gone.
void Container::detach(Dispatcher* dispatcher) {
  if (!dispatcher || dispatcher == dispatchers_.front().get()) return;
  if (clock_reader_) clock_reader_->on_move({});
  std::erase_if(dispatchers_, [&](const auto& other) { return other.get() == dispatcher; });
  tell_dispatchers_the_time();
}

RunReport Container::run_dispatchers(const RunControl& control) {
  const bool runs_time = spec_.clock == ClockMode::sim && !clock_reader_;
  Activity activity([this] {
    const std::lock_guard lock(finish_mutex_);
    finish_wanted_.notify_one();
  });
  start_dispatchers(runs_time ? &activity : nullptr);
  const RunReport report = runs_time ? run_simulated_time(control, activity) : supervise(control);
  if (clock_reader_) clock_reader_->on_move({});
  for (const auto& dispatcher : dispatchers_) dispatcher->stop();
  for (const auto& instance : instances_) instance->dispatcher = nullptr;
  activity_ = nullptr;
  instant_ = {clock_.now(), 0};
  return report;
}

std::optional<RunReport> Container::over(std::unique_lock<std::mutex>& finish_lock, const RunControl& control) {
  while (!finish_ && operations_->pending()) {
    finish_lock.unlock();
    operations_->run_posted();
    finish_lock.lock();
  }
  if (finish_) return RunReport{.end = RunEnd::finished, .reason = finish_->second};
  // A signal handler sets the flag and can do no more, so it has to be looked at now and then.
  if (stop_wanted(control)) return interrupted();
  return std::nullopt;
}

/// Waits for the end of a run, and shows its progress.
RunReport Container::supervise(const RunControl& control) {
  const Time end = control.limit == forever ? Time::max() : started_ + control.limit;
  std::unique_lock lock(finish_mutex_);
  for (;;) {
    if (auto ended = over(lock, control)) return *std::move(ended);
    const Time now = clock_.now();
    if (now >= end) return time_limit();
    if (const auto lost = lost_clock()) return *lost;
    if (control.progress) {
      lock.unlock();
      control.progress(now);
      lock.lock();
      if (finish_) continue;
    }
    finish_wanted_.wait_for(lock, std::min<Duration>(kProgressPeriod, end - now));
  }
}

/// Moves simulated time on to the next timer when its turn has come and nobody has anything left to do at the present
/// time. Time that cannot keep its pace becomes slower; no timer is ever late in it.
RunReport Container::run_simulated_time(const RunControl& control, const Activity& activity) {
  const Time end = control.limit == forever ? Time::max() : started_ + control.limit;
  Pace pace(spec_.pace, clock_.now(), Steady::now());
  Steady::time_point next_progress = Steady::now();
  std::unique_lock lock(finish_mutex_);
  for (;;) {
    if (auto ended = over(lock, control)) return *std::move(ended);
    const Steady::time_point now = Steady::now();
    if (control.progress && now >= next_progress) {
      next_progress = now + kProgressPeriod;
      lock.unlock();
      control.progress(clock_.now());
      lock.lock();
      continue;
    }
    if (!activity.idle()) {
      finish_wanted_.wait_for(lock, kProgressPeriod);
      continue;
    }
    Time next = Time::max();
    for (const auto& dispatcher : dispatchers_) next = std::min(next, dispatcher->next_wake());
    if (next == Time::max())
      return {.end = RunEnd::idle, .reason = "no component has a timer, so nothing would ever happen again"};
    const Steady::time_point due = pace.due(std::min(next, end), now);
    if (due > now) {
      finish_wanted_.wait_until(lock, std::min(due, now + kProgressPeriod));
      continue;
    }
    clock_.move_to(std::min(next, end));
    if (next > end) return time_limit();
    lock.unlock();
    for (const auto& dispatcher : dispatchers_) dispatcher->time_moved();
    lock.lock();
  }
}

/// Before the start there is no time at which anybody could be activated.
std::optional<RunReport> Container::wait_for_clock(const RunControl& control) {
  if (!clock_reader_) return std::nullopt;
  const Steady::time_point began = Steady::now();  // the wait for the other containers does not count
  while (!clock_reader_->wait_for_first(Steady::now() + kProgressPeriod)) {
    if (stop_wanted(control)) return interrupted();
    if (const auto wish = finish_wish()) return RunReport{.end = wish->end, .reason = wish->reason};
    if (Steady::now() - began >= kFirstClockPatience) return clock_lost(spec_, kFirstClockPatience);
  }
  return std::nullopt;
}

/// Without a pace the simulator may take its time, so silence alone says nothing.
std::optional<RunReport> Container::lost_clock() const {
  if (!clock_reader_ || clock_reader_->silence() < kClockPatience) return std::nullopt;
  if (spec_.pace <= 0.0 && !clock_reader_->writer_gone()) return std::nullopt;
  return clock_lost(spec_, kClockPatience);
}

}  // namespace kervan::runtime
