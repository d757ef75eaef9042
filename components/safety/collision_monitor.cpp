#include "components/safety/collision_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kervan::safety {
namespace {

using geometry::Pose2;
using geometry::Twist2;
using geometry::Vector2;

constexpr double step = 0.02;   // s
constexpr double slack = 1e-6;  // m that rounding may seem to bring a point nearer
/// Slower than this is standing: m/s and rad/s.
constexpr double least = 0.01;

Twist2 scaled(const Twist2& twist, double factor) { return {factor * twist.linear, factor * twist.angular}; }

}  // namespace

double CollisionMonitor::nearest(const Pose2& robot, std::span<const Vector2> points) const {
  const Pose2 to_robot = robot.inverse();
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vector2& point : points) nearest = std::min(nearest, clearance(params_.hull, to_robot * point));
  return nearest;
}

double CollisionMonitor::time_to_collision(const Twist2& twist, std::span<const Vector2> points) const {
  double allowed = std::min(params_.stop_margin, nearest({}, points) - slack);
  Pose2 robot;
  for (double time = 0.0; time < params_.time_to_collision; time += step) {
    robot = robot * Pose2{twist.linear * step * std::cos(0.5 * twist.angular * step),
                          twist.linear * step * std::sin(0.5 * twist.angular * step), twist.angular * step};
    const double room = nearest(robot, points);
    if (room < allowed) return time;
    allowed = std::min(params_.stop_margin, std::max(allowed, room - slack));
  }
  return params_.time_to_collision;
}

Checked CollisionMonitor::check(const Twist2& wanted, std::span<const Vector2> points) const {
  Checked checked{.twist = wanted, .time = params_.time_to_collision};
  const auto judge = [&](Verdict verdict, std::string_view why, double factor) {
    if (!(factor < 1.0)) return;
    checked.twist = scaled(checked.twist, factor);
    checked.verdict = verdict;
    checked.why = why;
  };
  if (!std::isfinite(wanted.linear) || !std::isfinite(wanted.angular)) {
    checked.twist = {};
    checked.verdict = Verdict::stopped;
    checked.why = "the command is not finite";
    return checked;
  }
  if (wanted.linear < -params_.max_reverse)
    judge(Verdict::slowed, "it drives backward", params_.max_reverse / -wanted.linear);
  if (wanted.linear > params_.slow_speed && nearest({}, points) < params_.slow_margin)
    judge(Verdict::slowed, "something is in the slow zone", params_.slow_speed / wanted.linear);
  checked.time = time_to_collision(checked.twist, points);
  judge(Verdict::slowed, "it would soon collide", checked.time / params_.time_to_collision);
  if (checked.verdict == Verdict::slowed && std::abs(checked.twist.linear) < least &&
      std::abs(checked.twist.angular) < least) {
    checked.twist = {};
    checked.verdict = Verdict::stopped;
    checked.why = "it would collide";
  }
  return checked;
}

}  // namespace kervan::safety
