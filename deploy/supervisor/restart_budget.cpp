#include "deploy/supervisor/restart_budget.hpp"

#include <algorithm>

namespace kervan::supervisor {
namespace {

using namespace std::chrono_literals;
constexpr Duration kLongEnough = 1s;

}  // namespace

std::optional<Duration> RestartBudget::spend(SteadyTime now, Duration active) {
  while (!recent_.empty() && now - recent_.front() > limits_.window) recent_.pop_front();
  if (recent() >= limits_.max) return std::nullopt;
  recent_.push_back(now);
  delay_ = delay_ == Duration::zero() || active >= kLongEnough ? limits_.backoff
                                                               : std::min(2 * delay_, limits_.longest_backoff);
  return delay_;
}

void RestartBudget::forgive() {
  recent_.clear();
  delay_ = Duration::zero();
}

}  // namespace kervan::supervisor
