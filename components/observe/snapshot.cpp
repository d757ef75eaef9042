#include "components/observe/snapshot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kervan::observe {

using geometry::Pose2;
using geometry::Vector2;

Polyline cone(const Pose2& transducer, double field_of_view, double range) {
  if (!(range > 0.0) || !std::isfinite(range)) return {};
  constexpr double finest = 0.05;  // of the arc, radians: its chords stay within 0.03 % of the range
  const int steps = std::clamp(static_cast<int>(std::ceil(field_of_view / finest)), 1, 200);
  Polyline area{transducer.position()};
  for (int i = 0; i <= steps; ++i)
    area.push_back(transducer * Vector2(range * geometry::heading(field_of_view * (i / double(steps) - 0.5))));
  return area;
}

std::vector<Polyline> sweep(const Pose2& laser, double first_angle, double increment, std::span<const float> ranges) {
  std::vector<Polyline> areas;
  Polyline area;
  const auto end_area = [&] {
    if (area.size() > 2) areas.push_back(std::move(area));
    area.clear();
  };
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double range = ranges[i];
    if (!(range > 0.0) || !std::isfinite(range)) {
      end_area();
      continue;
    }
    if (area.empty()) area.push_back(laser.position());
    const double angle = first_angle + static_cast<double>(i) * increment;
    area.push_back(laser * Vector2(range * geometry::heading(angle)));
  }
  end_area();
  return areas;
}

Pose2 moved_back(const Pose2& pose, const geometry::Twist2& speed, double time) {
  // The chord of the arc points along the mean heading.
  const double half = -0.5 * speed.angular * time;
  const double chord = -speed.linear * time * (half == 0.0 ? 1.0 : std::sin(half) / half);
  const Vector2 moved = chord * geometry::heading(pose.yaw + half);
  return {pose.x + moved.x(), pose.y + moved.y(), geometry::wrap_angle(pose.yaw + 2.0 * half)};
}

}  // namespace kervan::observe
