/// Follows the simulated time that another container publishes on /clock.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>

#include "framework/dds/endpoint.hpp"
#include "framework/runtime/clock.hpp"
#include "framework/runtime/spec.hpp"

namespace kervan::runtime {

inline constexpr const char* kClockTopic = "/clock";

/// With a pace, time may stand still for so long before the clock counts as lost; real time.
inline constexpr auto kClockPatience = std::chrono::seconds(2);

/// Who writes /clock, as far as the spec says.
struct ClockWriter {
  std::string component;
  std::string container;
  Reliability reliability;
};
std::optional<ClockWriter> clock_writer(const ContainerSpec& spec);

class ClockReader final : public dds::SampleSink {
 public:
  using Steady = std::chrono::steady_clock;

  /// Moves `clock`, which must outlive the reader. A time that is lost would hold up everybody who follows it, so
  /// `reliability` is less than reliable only if the writer is. Throws DdsError.
  ClockReader(dds::Domain& domain, ContainerClock& clock, Reliability reliability);
  ~ClockReader() = default;

  /// `moved` is called after each step, in the thread that receives and under Cyclone's locks; an empty one ends that.
  /// After this returns the earlier one is not called any more.
  void on_move(std::function<void()> moved);

  /// Waits until the clock has been heard of, at most until `deadline`; false if it has not been.
  bool wait_for_first(Steady::time_point deadline);

  /// How long nothing has come, in real time; since the reader was made if nothing ever has.
  Duration silence() const;
  /// Whoever wrote the clock has left, and nothing has come since.
  bool writer_gone() const;

  void on_sample(const dds::Arrival& arrival) noexcept override;
  void on_writer_gone(std::uint64_t writer) noexcept override;
  void on_status() noexcept override {}

 private:
  ContainerClock& clock_;
  mutable std::mutex mutex_;
  std::condition_variable first_;
  std::function<void()> moved_;  ///< under mutex_ like all below
  bool heard_ = false;
  bool gone_ = false;
  Steady::time_point last_ = Steady::now();
  dds::Reader reader_;  ///< last: it calls into the members above
};

}  // namespace kervan::runtime
