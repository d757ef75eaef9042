#include "sim/moving_body.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::sim {

namespace {
constexpr double skin = 1e-6;          // m; it comes no nearer to anybody
constexpr double longest_move = 0.01;  // m; far less than any body is wide, so nobody is jumped over
}  // namespace

MovingBody::MovingBody(const MovingObstacle& obstacle)
    : obstacle_(&obstacle), pose_(pose_at(obstacle, Duration::zero())) {
  for (std::size_t i = 1; i < obstacle.path.size(); ++i) {
    const Waypoint &from = obstacle.path[i - 1], &to = obstacle.path[i];
    const double way = (to.pose.position() - from.pose.position()).norm() +
                       obstacle.outline.circumradius() * std::abs(to.pose.yaw - from.pose.yaw);
    fastest_ = std::max(fastest_, way / seconds(to.at - from.at));
  }
}

bool MovingBody::try_time(Duration time, const Surroundings& around) {
  const Pose2 pose = pose_at(*obstacle_, time);
  if (!(around.room(obstacle_->outline, pose).all.distance > skin)) return false;
  time_ = time;
  pose_ = pose;
  return true;
}

std::optional<MovingBody::Touch> MovingBody::move(Duration dt, const Surroundings& around) {
  const Duration end = time_ + dt;
  const double way = fastest_ * seconds(dt), near = way + 2.0 * skin;
  if (around.room_among_bodies(obstacle_->outline, pose_, near) >= near) {
    time_ = end;
    pose_ = pose_at(*obstacle_, end);
    return std::nullopt;
  }
  const auto moves = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(way / longest_move)));
  for (std::int64_t i = 1; i <= moves; ++i) {
    Duration blocked = end - dt + Duration(dt.count() * i / moves);
    if (try_time(blocked, around)) continue;
    // As near as it can come.
    const auto nearer = [&] { return fastest_ * seconds(blocked - time_) > skin && blocked - time_ > Duration(1); };
    while (nearer()) {
      const Duration middle = time_ + (blocked - time_) / 2;
      if (!try_time(middle, around)) blocked = middle;
    }
    const Room room = around.room(obstacle_->outline, pose_at(*obstacle_, blocked));
    return Touch{room.other ? *room.other : std::string(), room.all.on_obstacle};
  }
  return std::nullopt;
}

}  // namespace kervan::sim
