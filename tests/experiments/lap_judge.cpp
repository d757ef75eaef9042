#include "tests/experiments/lap_judge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kervan::test {

LapJudge::LapJudge(const sim::World& world, const geometry::Vector2& middle, behavior::Side side)
    : walls_(world.segments().begin(), world.segments().end()),
      middle_(middle),
      ears_(-0.044, side == behavior::Side::right ? -0.136 : 0.136) {
  for (const sim::Box& box : world.boxes()) {
    const auto corners = sim::corners(box);
    for (std::size_t i = 0; i < corners.size(); ++i) walls_.push_back({corners[i], corners[(i + 1) % corners.size()]});
  }
}

void LapJudge::add(double time, const geometry::Pose2& robot) {
  const geometry::Vector2 around = robot.position() - middle_;
  const double angle = std::atan2(around.y(), around.x());
  if (last_angle_) angle_ += geometry::angle_between(*last_angle_, angle);
  last_angle_ = angle;

  const geometry::Vector2 ears = robot * ears_;
  double nearest = behavior::nothing, before = 0.0, after = 0.0;  // m to the ends behind and ahead
  for (const sim::Segment& wall : walls_) {
    const double length = (wall.b - wall.a).norm();
    const geometry::Vector2 along = (wall.b - wall.a) / length;
    const double foot = std::clamp((ears - wall.a).dot(along), 0.0, length);
    const double distance = (wall.a + foot * along - ears).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    const bool forward = along.dot(geometry::heading(robot.yaw)) > 0.0;
    before = forward ? foot : length - foot;
    after = forward ? length - foot : foot;
  }
  if (before < 1.5 || after < 1.0) return;
  const bool inside = nearest >= 0.35 && nearest <= 0.45;
  if (inside && !found_) found_ = time;
  if (!found_) return;
  ++on_straight_;
  inside_ += inside;
}

double LapJudge::laps() const { return std::abs(angle_) / (2.0 * std::numbers::pi); }

}  // namespace kervan::test
