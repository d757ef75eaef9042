#include "components/control/seen_points.hpp"

#include <cmath>

namespace kervan::control {
namespace {

using geometry::Vector2;

/// What a beam may differ from a point it meets again.
double blur(double range) { return 0.05 + 0.03 * range; }

/// Whether a scan says that nothing is at `point`, or what is: both leave no need to remember it.
bool sees(const geometry::Scan& scan, const Vector2& point) {
  const double range = point.norm();
  if (range >= scan.range_max) return false;
  const double angle = std::atan2(point.y(), point.x());
  // A field of view of more than a half turn begins behind the robot.
  double steps = geometry::wrap_angle(angle - scan.angle_min) / scan.angle_increment;
  if (steps < -0.5) steps += 2.0 * std::numbers::pi / std::abs(scan.angle_increment);
  const auto beam = std::llround(steps);
  if (beam < 0 || beam >= static_cast<long long>(scan.ranges.size())) return false;
  const auto seen = static_cast<double>(scan.ranges[static_cast<std::size_t>(beam)]);
  return seen >= range - blur(range);  // not NaN, not -infinity
}

}  // namespace

bool SeenPoints::claim(const Vector2& at) {
  const auto number = [&](double x) {
    return static_cast<std::size_t>(static_cast<std::int64_t>(std::floor(x / params_.spacing))) % side;
  };
  std::uint32_t& round = rounds_[number(at.y()) * side + number(at.x())];
  if (round == round_) return false;
  round = round_;
  return true;
}

void SeenPoints::begin_round() {
  if (++round_ == 0) {
    rounds_.assign(rounds_.size(), 0u);
    round_ = 1;
  }
  std::swap(points_, before_);
  points_.clear();
}

void SeenPoints::look(const geometry::Pose2& laser, const geometry::Scan& scan, Time now) {
  begin_round();
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const auto range = static_cast<double>(scan.ranges[i]);
    if (!(range >= scan.range_min && range < scan.range_max && range <= params_.reach)) continue;
    const Vector2 at =
        laser * Vector2(range * geometry::heading(scan.angle_min + static_cast<double>(i) * scan.angle_increment));
    if (claim(at)) points_.push_back({at, now});
  }
  const geometry::Pose2 to_laser = laser.inverse();
  for (const Point& point : before_) {
    if (now - point.seen > params_.memory) continue;
    const Vector2 at = to_laser * point.at;
    if (at.norm() > params_.reach || sees(scan, at)) continue;
    if (claim(point.at)) points_.push_back(point);
  }
}

void SeenPoints::add(std::span<const Vector2> echoes, const Vector2& sensor, Time now) {
  begin_round();
  const auto near = [&](const Vector2& at) { return (at - sensor).norm() <= params_.reach; };
  for (const Vector2& echo : echoes)
    if (near(echo) && claim(echo)) points_.push_back({echo, now});
  for (const Point& point : before_)
    if (now - point.seen <= params_.memory && near(point.at) && claim(point.at)) points_.push_back(point);
}

}  // namespace kervan::control
