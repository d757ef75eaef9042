/// When simulated times are due in real time.
#pragma once

#include <chrono>

#include "framework/component/time.hpp"

namespace kervan::runtime {

class Pace {
 public:
  using Steady = std::chrono::steady_clock;

  /// What is made up after a delay, in simulated time. A longer one is lost: time that rushed would make commands old
  /// before whoever sends them had a chance to send another. Of the 50 ms that a drive guard leaves for the way to the
  /// drive, this must be a small part.
  static constexpr Duration most_made_up = std::chrono::milliseconds(20);

  /// `factor` is simulated over real time; 0: everything is due at once.
  Pace(double factor, Time start, Steady::time_point now) : factor_(factor), time_(start), steady_(now) {}

  /// When `time` is due, which may be past.
  Steady::time_point due(Time time, Steady::time_point now) {
    if (factor_ <= 0.0) return now;
    const Steady::time_point due = steady_ + real(time - time_);
    if (now - due <= real(most_made_up)) return due;
    time_ = time;
    steady_ = now;
    return now;
  }

 private:
  Duration real(Duration simulated) const { return from_seconds(seconds(simulated) / factor_); }

  double factor_;
  Time time_;  ///< due at steady_
  Steady::time_point steady_;
};

}  // namespace kervan::runtime
