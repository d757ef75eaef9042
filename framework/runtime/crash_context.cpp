#include "framework/runtime/crash_context.hpp"

#include <signal.h>
#include <sys/mman.h>

#include <utility>

namespace kervan::runtime {

namespace {

// initial-exec: with the usual model of a shared library the first access of a thread may allocate, and that first
// access may be a signal handler's.
[[gnu::tls_model("initial-exec")]] thread_local CrashContext running;

constexpr std::size_t kStackSize = 64 * 1024;

}  // namespace

RunningCode::RunningCode(const char* component, const char* handler, Time now) noexcept
    : outer_(std::exchange(running, {component, handler, now.time_since_epoch().count()})) {}
RunningCode::~RunningCode() { running = outer_; }
CrashContext RunningCode::current() noexcept { return running; }

HandlerStack::HandlerStack() {
  stack_t present{};
  if (sigaltstack(nullptr, &present) != 0 || !(present.ss_flags & SS_DISABLE)) return;
  void* const memory =
      mmap(nullptr, kStackSize, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_STACK | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) return;
  stack_t stack{};
  stack.ss_sp = memory;
  stack.ss_size = kStackSize;
  if (sigaltstack(&stack, nullptr) == 0)
    memory_ = memory;
  else
    munmap(memory, kStackSize);
}

HandlerStack::~HandlerStack() {
  if (!memory_) return;
  stack_t none{};
  none.ss_flags = SS_DISABLE;
  sigaltstack(&none, nullptr);
  munmap(memory_, kStackSize);
}

}  // namespace kervan::runtime
