#include "components/control/route_follower.hpp"

#include <algorithm>
#include <utility>

namespace kervan::control {

using geometry::Vector2;

void RouteFollower::start(std::vector<Vector2> route) {
  route_ = std::move(route);
  index_ = 0;
  arrived_ = false;
  ahead_.reset();
}

RouteFollower::Foot RouteFollower::foot(std::size_t from, const Vector2& position) const {
  const Vector2 leg = route_[from + 1] - route_[from];
  const double length2 = leg.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp((position - route_[from]).dot(leg) / length2, 0.0, 1.0) : 1.0;
  const Vector2 at = route_[from] + share * leg;
  return {at, (position - at).norm()};
}

void RouteFollower::join(const Vector2& position) {
  if (route_.empty() || arrived_ || !position.allFinite()) return;
  double nearest = (route_.front() - position).norm();
  for (std::size_t i = index_ + 1; i < route_.size(); ++i) {
    const double distance = foot(i - 1, position).distance;
    if (!(distance < nearest)) continue;
    nearest = distance;
    index_ = i;
  }
}

/// Goes on along the route to where it is nearest to the position, and says where that is. What lies farther along it
/// than the look-ahead reaches is another part of the route that happens to come near.
Vector2 RouteFollower::pass_legs(const Vector2& position) {
  Vector2 nearest = route_.front();
  double distance = (nearest - position).norm(), way = 0.0;
  if (index_ > 0) {
    const Foot now = foot(index_ - 1, position);
    nearest = now.at;
    distance = now.distance;
    way = (route_[index_] - nearest).norm();
  }
  for (std::size_t i = index_ + 1; i < route_.size() && way <= params_.look_ahead; ++i) {
    const Foot next = foot(i - 1, position);
    if (next.distance < distance) {
      nearest = next.at;
      distance = next.distance;
      index_ = i;
    }
    way += (route_[i] - route_[i - 1]).norm();
  }
  return nearest;
}

/// Whether the waypoints from the present one up to `end` lie near the line.
bool RouteFollower::straight_enough(const Vector2& from, const Vector2& to, std::size_t end) const {
  const Vector2 line = to - from;
  const double length2 = line.squaredNorm();
  for (std::size_t i = index_; i < end; ++i) {
    const double share = length2 > 0.0 ? std::clamp((route_[i] - from).dot(line) / length2, 0.0, 1.0) : 0.0;
    if ((route_[i] - from - share * line).norm() > params_.cut_corners) return false;
  }
  return true;
}

Vector2 RouteFollower::point_ahead(const Vector2& position, const Vector2& on_route) const {
  Vector2 from = on_route;
  double left = params_.look_ahead;
  for (std::size_t i = index_; i < route_.size(); ++i) {
    const Vector2 leg = route_[i] - from;
    const double length = leg.norm(), most = length > left ? left / length : 1.0;
    const auto sees = [&](double share) { return straight_enough(position, from + share * leg, i); };
    if (!sees(most)) {
      double good = 0.0, bad = most;
      for (int halving = 0; halving < 10; ++halving) {
        const double middle = 0.5 * (good + bad);
        (sees(middle) ? good : bad) = middle;
      }
      return from + good * leg;
    }
    if (length >= left) return from + most * leg;
    left -= length;
    from = route_[i];
  }
  return route_.back();
}

bool RouteFollower::advance(const Vector2& position) {
  if (route_.empty() || arrived_ || !position.allFinite()) return false;
  const std::size_t last = route_.size() - 1;
  const std::size_t before = index_;
  bool moved = false;
  if (params_.look_ahead > 0.0) {
    const Vector2 ahead = point_ahead(position, pass_legs(position));
    moved = ahead_ != ahead;
    ahead_ = ahead;
  } else {
    ahead_.reset();
    while (index_ < last && (route_[index_] - position).norm() <= params_.pass_within) ++index_;
  }
  if (index_ == last) arrived_ = (route_[last] - position).norm() <= params_.arrive_within;
  return moved || index_ != before || arrived_;
}

std::optional<Vector2> RouteFollower::waypoint() const {
  if (route_.empty()) return std::nullopt;
  return ahead_ ? *ahead_ : route_[index_];
}

}  // namespace kervan::control
