#include "components/control/route_follower.hpp"

#include <algorithm>
#include <utility>

namespace kervan::control {

void RouteFollower::start(std::vector<geometry::Vector2> route) {
  route_ = std::move(route);
  index_ = 0;
  arrived_ = false;
}

void RouteFollower::join(const geometry::Vector2& position) {
  if (route_.empty() || arrived_ || !position.allFinite()) return;
  double nearest = (route_.front() - position).norm();
  for (std::size_t i = index_ + 1; i < route_.size(); ++i) {
    const geometry::Vector2& from = route_[i - 1];
    const geometry::Vector2 leg = route_[i] - from;
    const double length2 = leg.squaredNorm();
    const double share = length2 > 0.0 ? std::clamp((position - from).dot(leg) / length2, 0.0, 1.0) : 1.0;
    const double distance = (position - from - share * leg).norm();
    if (!(distance < nearest)) continue;
    nearest = distance;
    index_ = i;
  }
}

bool RouteFollower::advance(const geometry::Vector2& position) {
  if (route_.empty() || arrived_) return false;
  const std::size_t last = route_.size() - 1;
  const std::size_t before = index_;
  while (index_ < last && (route_[index_] - position).norm() <= params_.pass_within) ++index_;
  if (index_ == last) arrived_ = (route_[last] - position).norm() <= params_.arrive_within;
  return index_ != before || arrived_;
}

std::optional<geometry::Vector2> RouteFollower::waypoint() const {
  if (route_.empty()) return std::nullopt;
  return route_[index_];
}

}  // namespace kervan::control
