#include "framework/workers/worker_pool.hpp"

#include <algorithm>

namespace kervan::workers {

namespace {
constexpr std::size_t portions = 16;  // for each thread, so that none ends much later than the others

/// Often the next round comes soon: sooner than a thread that sleeps is awake again.
template <class Happened>
void wait_awake(Happened&& happened) {
  constexpr int turns = 400;  // some 200 us
  for (int i = 0; i < turns && !happened(); ++i) std::this_thread::yield();
}
}  // namespace

WorkerPool::WorkerPool(int threads) {
  for (int i = 1; i < threads; ++i) others_.emplace_back([this] { serve(); });
}

WorkerPool::~WorkerPool() {
  end_ = true;
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  for (std::thread& other : others_) other.join();
}

void WorkerPool::share(std::size_t count, Call call, void* context) {
  call_ = call;
  context_ = context;
  count_ = count;
  portion_ = std::max<std::size_t>(1, count / (portions * (others_.size() + 1)));
  next_.store(0, std::memory_order_relaxed);
  at_work_.store(static_cast<std::uint32_t>(others_.size()), std::memory_order_relaxed);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  take_part();
  wait_awake([this] { return at_work_.load(std::memory_order_acquire) == 0; });
  while (const std::uint32_t left = at_work_.load(std::memory_order_acquire))
    at_work_.wait(left, std::memory_order_acquire);
}

void WorkerPool::take_part() {
  for (;;) {
    const std::size_t first = next_.fetch_add(portion_, std::memory_order_relaxed);
    if (first >= count_) return;
    for (std::size_t i = first; i < std::min(first + portion_, count_); ++i) call_(context_, i);
  }
}

void WorkerPool::serve() {
  for (std::uint32_t seen = 0;;) {
    wait_awake([this, seen] { return round_.load(std::memory_order_acquire) != seen; });
    round_.wait(seen, std::memory_order_acquire);
    seen = round_.load(std::memory_order_acquire);
    if (end_) return;
    take_part();
    if (at_work_.fetch_sub(1, std::memory_order_acq_rel) == 1) at_work_.notify_one();
  }
}

}  // namespace kervan::workers
