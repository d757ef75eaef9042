#include "components/observe/barn_score.hpp"

#include <algorithm>

namespace kervan::observe {

std::string_view to_text(BarnOutcome outcome) {
  switch (outcome) {
    case BarnOutcome::running: return "running";
    case BarnOutcome::success: return "success";
    case BarnOutcome::collision: return "collision";
    case BarnOutcome::timeout: return "timeout";
  }
  return "";
}

void BarnScore::truth(double now, const geometry::Vector2& position) {
  if (outcome_ != BarnOutcome::running) return;
  if (!start_) {
    start_ = position;
    first_ = now;
  }
  if (last_) length_ += (position - *last_).norm();
  last_ = position;
  if (!begun_ && (position - *start_).norm() >= params_.begun_after) begun_ = now;
  time_ = begun_ ? now - *begun_ : 0.0;
  if ((position - params_.goal).norm() <= params_.within)
    outcome_ = BarnOutcome::success;
  else if (now - begun_.value_or(*first_) >= params_.limit)
    outcome_ = BarnOutcome::timeout;
}

void BarnScore::contact() {
  if (outcome_ == BarnOutcome::running) outcome_ = BarnOutcome::collision;
}

double BarnScore::metric() const {
  if (outcome_ != BarnOutcome::success) return 0.0;
  const double optimal = params_.reference / params_.reference_speed;
  return optimal > 0.0 ? optimal / std::clamp(time_, 2.0 * optimal, 8.0 * optimal) : 0.0;
}

}  // namespace kervan::observe
