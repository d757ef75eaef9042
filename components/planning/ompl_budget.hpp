/// How long a planner of OMPL may take.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

namespace kervan::planning {

/// OMPL's planners ask now and then whether they should stop, some of them rarely: LazyPRM* and BIT* have been seen to
/// take sixteen times as long as they were given. So what they cannot do without, distances and motions, is counted
/// here, and what asks for more of it when the time is long over is thrown out of the planner.
///
/// A step is about what it takes to compute the distance of two points among many. A budget of steps is spent in the
/// same way on every machine; one of seconds is looked at every few steps.
class OmplBudget {
 public:
  /// Thrown out of the planner.
  struct Spent {};

  static constexpr double steps_per_second = 2e7;  ///< what a budget of steps takes a core of an AMD EPYC for
  static constexpr double grace = 0.010;           ///< s, from the end of the budget to when it is taken away

  static OmplBudget of_seconds(double seconds);
  static OmplBudget of_steps(std::uint64_t steps);

  /// Asked every few steps; true: nobody needs the result any more, and the budget is over.
  void set_cancelled(std::function<bool()> cancelled) { cancelled_ = std::move(cancelled); }

  /// From now on over() is true when this share of the whole budget, 0 .. 1, is spent.
  void allow(double share);

  /// What a planner asks. It is a step, too, so that asking for ever comes to an end.
  bool over() {
    spend(1);
    return over_;
  }

  void spend(unsigned steps) {
    steps_ += steps;
    if (steps_ >= look_at_) look();
  }

  /// From now on nothing is thrown.
  void settle() { settled_ = true; }

  bool cancelled() const { return was_cancelled_; }
  std::uint64_t steps() const { return steps_; }

 private:
  using Clock = std::chrono::steady_clock;

  OmplBudget() = default;
  void look();
  void cancel();

  std::function<bool()> cancelled_;
  double seconds_ = 0.0;          // 0: counts steps
  std::uint64_t most_steps_ = 0;  // 0: looks at the clock
  Clock::time_point begun_{}, enough_{}, last_{};
  std::uint64_t enough_steps_ = 0, last_steps_ = 0;
  std::uint64_t steps_ = 0, look_at_ = 0;
  bool over_ = false, settled_ = false, was_cancelled_ = false;
};

}  // namespace kervan::planning
