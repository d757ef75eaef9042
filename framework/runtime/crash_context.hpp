/// Which component's code a thread runs at the moment, kept where a signal handler can read it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "framework/component/time.hpp"

namespace kervan::runtime {

struct CrashContext {
  const char* component = nullptr;  ///< nullptr: no component's code runs
  const char* handler = nullptr;    ///< "a timer", "on_activate", the name of a port
  std::int64_t time_ns = 0;         ///< on the composition's clock
};

/// While it exists, this thread runs that component's code. The texts must outlive it.
class RunningCode {
 public:
  RunningCode(const char* component, const char* handler, Time now) noexcept;
  ~RunningCode();
  RunningCode(const RunningCode&) = delete;
  RunningCode& operator=(const RunningCode&) = delete;

  /// Of the calling thread. May be called by a signal handler.
  static CrashContext current() noexcept;

 private:
  CrashContext outer_;
};

/// Gives the calling thread a second stack for signal handlers while it exists: the report of an overflow of the first
/// one needs a place to run. A process that reports no crashes loses 64 KiB of address space by it.
class HandlerStack {
 public:
  HandlerStack();
  ~HandlerStack();
  HandlerStack(const HandlerStack&) = delete;
  HandlerStack& operator=(const HandlerStack&) = delete;

 private:
  void* memory_ = nullptr;  ///< nullptr if the thread has a second stack already, or there is no memory
};

}  // namespace kervan::runtime
