/// The composition's time in one container: real time, or simulated time that moves in steps. Any thread may ask.
#pragma once

#include <atomic>

#include "framework/component/time.hpp"
#include "framework/dds/wall_clock.hpp"

namespace kervan::runtime {

class ContainerClock {
 public:
  /// `stepped`: simulated time, which stands at 0 until the first move_to().
  explicit ContainerClock(bool stepped) : stepped_(stepped) {}
  ContainerClock(const ContainerClock&) = delete;
  ContainerClock& operator=(const ContainerClock&) = delete;

  Time now() const noexcept {
    return stepped_ ? Time(Duration(now_.load(std::memory_order_acquire))) : dds::wall_now();
  }
  bool stepped() const noexcept { return stepped_; }

  /// Simulated time only; a time that is already past is ignored. From one thread at a time.
  void move_to(Time time) noexcept {
    if (time > now()) now_.store(time.time_since_epoch().count(), std::memory_order_release);
  }

  /// What stamps samples from other containers; nullptr for real time.
  const std::atomic<Time::rep>* stamp() const noexcept { return stepped_ ? &now_ : nullptr; }

 private:
  const bool stepped_;
  std::atomic<Time::rep> now_{0};
};

}  // namespace kervan::runtime
