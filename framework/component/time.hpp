/// Time of a composition: nanoseconds on the composition's own clock (wall, simulated or logical).
#pragma once

#include <chrono>
#include <cstdint>

namespace kervan {

using Duration = std::chrono::nanoseconds;

/// Tag of the composition's clock. It has no now(): the time reaches a component as an argument of its handlers.
struct CompositionClock {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<CompositionClock>;
  static constexpr bool is_steady = true;
};

/// Under `lockstep` and `sim` the epoch is the start of the run; under `wall` it is the Unix epoch at the start of the
/// container, carried on by the steady clock, so that a set wall clock never moves it.
using Time = CompositionClock::time_point;

inline constexpr Duration forever = Duration::max();

/// Seconds as a double, for arithmetic in SI units.
constexpr double seconds(Duration d) { return std::chrono::duration<double>(d).count(); }
constexpr double seconds(Time t) { return seconds(t.time_since_epoch()); }

/// The nearest nanosecond; the argument is in seconds.
constexpr Duration from_seconds(double s) {
  return Duration(static_cast<std::int64_t>(s * 1e9 + (s < 0 ? -0.5 : 0.5)));
}

}  // namespace kervan
