/// Threads that share out work among them: the robots of a simulator, the components of a lockstep run.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <type_traits>
#include <vector>

namespace kervan::workers {

class WorkerPool {
 public:
  /// `threads` in all, at least 1; the one that calls is one of them.
  explicit WorkerPool(int threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Calls work(i) once for every i below `count`, on any of the threads and in any order, and returns when all is
  /// done; the calling thread alone does fewer than `worth_sharing` of them. `work` must not throw and must not call
  /// this.
  template <class Work>
  void for_each(std::size_t count, std::size_t worth_sharing, Work&& work) {
    using Type = std::remove_reference_t<Work>;
    if (others_.empty() || count < worth_sharing) {
      for (std::size_t i = 0; i < count; ++i) work(i);
      return;
    }
    share(
        count, [](void* context, std::size_t i) { (*static_cast<Type*>(context))(i); },
        const_cast<std::remove_const_t<Type>*>(&work));
  }

 private:
  using Call = void (*)(void* context, std::size_t i);
  void share(std::size_t count, Call call, void* context);
  void take_part();
  void serve();

  // The work in hand; written while all the others wait.
  Call call_ = nullptr;
  void* context_ = nullptr;
  std::size_t count_ = 0;
  std::size_t portion_ = 1;  // taken at a time
  bool end_ = false;

  std::atomic<std::size_t> next_{0};       // nobody has taken what begins here
  std::atomic<std::uint32_t> round_{0};    // grows with every piece of work
  std::atomic<std::uint32_t> at_work_{0};  // threads that have not finished this round
  std::vector<std::thread> others_;
};

}  // namespace kervan::workers
