#include "components/planning/ompl_budget.hpp"

#include <algorithm>

namespace kervan::planning {
namespace {

constexpr std::uint64_t between_looks = 200;  // steps: about 10 us
constexpr auto grace_steps = static_cast<std::uint64_t>(OmplBudget::grace * OmplBudget::steps_per_second);

std::chrono::nanoseconds nanoseconds_of(double seconds) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * seconds));
}

}  // namespace

OmplBudget OmplBudget::of_seconds(double seconds) {
  OmplBudget budget;
  budget.seconds_ = seconds;
  budget.begun_ = Clock::now();
  budget.last_ = budget.begun_ + nanoseconds_of(seconds + grace);
  budget.allow(1.0);
  return budget;
}

OmplBudget OmplBudget::of_steps(std::uint64_t steps) {
  OmplBudget budget;
  budget.most_steps_ = steps;
  budget.last_steps_ = steps + grace_steps;
  budget.allow(1.0);
  return budget;
}

void OmplBudget::allow(double share) {
  enough_ = begun_ + nanoseconds_of(share * seconds_);
  enough_steps_ = static_cast<std::uint64_t>(share * static_cast<double>(most_steps_));
  look_at_ = 0;
}

void OmplBudget::look() {
  look_at_ = steps_ + between_looks;
  if (cancelled_ && !was_cancelled_ && cancelled_()) cancel();
  bool spent = false;
  if (most_steps_ > 0) {
    over_ = steps_ >= enough_steps_;
    spent = steps_ >= last_steps_;
  } else {
    const Clock::time_point now = Clock::now();
    over_ = now >= enough_;
    spent = now >= last_;
  }
  over_ = over_ || was_cancelled_;
  if (spent && !settled_) throw Spent{};
}

/// The planner may end by itself, as it does at the end of its budget: most do at once, and then lose no memory.
void OmplBudget::cancel() {
  was_cancelled_ = true;
  last_steps_ = std::min(last_steps_, steps_ + grace_steps);
  last_ = std::min(last_, Clock::now() + nanoseconds_of(grace));
}

}  // namespace kervan::planning
