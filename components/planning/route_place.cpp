#include "components/planning/route_place.hpp"

#include <algorithm>

namespace kervan::planning {

void RoutePlace::start(const std::vector<geometry::Vector2>& points) {
  points_ = points;
  length_ = along_ = off_ = leg_at_ = 0.0;
  leg_ = 0;
  for (std::size_t i = 1; i < points_.size(); ++i) length_ += (points_[i] - points_[i - 1]).norm();
  if (!points_.empty()) last_ = points_.front();
}

void RoutePlace::move(const geometry::Vector2& position) {
  if (points_.empty() || !position.allFinite()) return;
  constexpr double slack = 0.5;  // m, for corners that the robot cuts
  const double farthest = along_ + (position - last_).norm() + slack;
  last_ = position;
  off_ = (points_[leg_] - position).norm();
  along_ = leg_at_;
  double begins = leg_at_;
  for (std::size_t i = leg_ + 1; i < points_.size() && begins <= farthest; ++i) {
    const geometry::Vector2 leg = points_[i] - points_[i - 1];
    const double length = leg.norm();
    const double at = length > 0.0 ? std::clamp((position - points_[i - 1]).dot(leg) / length, 0.0,
                                                std::min(length, farthest - begins))
                                   : 0.0;
    const double off = (points_[i - 1] + leg * (length > 0.0 ? at / length : 0.0) - position).norm();
    if (off < off_) {
      off_ = off;
      along_ = begins + at;
      leg_ = i - 1;
      leg_at_ = begins;
    }
    begins += length;
  }
}

}  // namespace kervan::planning
