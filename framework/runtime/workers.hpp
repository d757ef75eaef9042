/// A few threads that run one batch of work at a time, for lockstep with several threads.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace kervan::runtime {

class WorkerPool {
 public:
  /// `threads` in all, the calling one included.
  explicit WorkerPool(unsigned threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Calls work(0) … work(count - 1), in any order and thread, and returns when all have returned. They must not throw.
  void run(std::size_t count, const std::function<void(std::size_t)>& work);

 private:
  void serve();
  void drain();

  std::mutex mutex_;
  std::condition_variable begin_;
  std::condition_variable done_;
  const std::function<void(std::size_t)>* work_ = nullptr;  ///< under mutex_ like all below
  std::size_t count_ = 0;
  std::uint64_t batch_ = 0;
  unsigned busy_ = 0;
  bool stopping_ = false;
  std::atomic<std::size_t> next_{0};
  std::vector<std::thread> threads_;
};

}  // namespace kervan::runtime
