#include "components/control/vfh_openings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kervan::control {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double tolerance = 0.01;    // of a degree: angles of a scan are single-precision numbers
constexpr double equal_costs = 1e-9;  // degrees; sums of the same angles in another order differ in their last bit
constexpr double last = opening_beams - 1;

/// Between two directions, 0 .. 180 degrees.
double between(double from, double to) { return std::abs(std::remainder(to - from, 360.0)); }

/// Of the opening from beam `first` to beam `end` - 1.
double candidate(const OpeningParams& params, std::size_t first, std::size_t end, double target) {
  const double left = static_cast<double>(end - 1), right = static_cast<double>(first), middle = 0.5 * (right + left);
  if (!params.clip) return middle;
  const double room = 0.5 * params.least_width;
  return std::clamp(middle + std::remainder(target - middle, 360.0), right + room, left - room);
}

}  // namespace

std::string_view resample(const geometry::Scan& scan, OpeningBeams& beams) {
  const double spacing = scan.angle_increment / degree, first = 90.0 + scan.angle_min / degree;
  const double end = first + spacing * (static_cast<double>(scan.ranges.size()) - 1.0);
  if (std::abs(spacing) > 1.0 + tolerance) return "its beams are more than a degree apart";
  if (scan.ranges.empty() || std::min(first, end) > tolerance || std::max(first, end) < last - tolerance)
    return "it does not cover 180 degrees ahead";
  beams.fill(std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double at = std::round(first + spacing * static_cast<double>(i));
    if (at < 0.0 || at > last) continue;
    float& beam = beams[static_cast<std::size_t>(at)];
    const float range = scan.ranges[i];
    if (!std::isnan(range) && !(beam <= range)) beam = range;
  }
  return {};
}

std::optional<double> best_opening(const OpeningParams& params, const OpeningBeams& beams,
                                   const OpeningDirections& directions) {
  const double sum = params.a + params.b + params.c;
  const double a = params.a / sum, b = params.b / sum, c = params.c / sum;
  std::optional<double> best;
  double least = 0.0;
  const auto free = [&](std::size_t beam) { return static_cast<double>(beams[beam]) > params.free_range; };
  for (std::size_t first = 0, end = 0; first < opening_beams; first = end + 1) {
    end = first;
    while (end < opening_beams && free(end)) ++end;
    if (end == first || static_cast<double>(end - 1 - first) < params.least_width) continue;
    const double at = candidate(params, first, end, directions.target);
    const double cost = a * between(at, directions.target) + b * between(at, directions.heading) +
                        (directions.before ? c * between(at, *directions.before) : 0.0);
    if (best && cost > least - equal_costs) continue;
    best = at;
    least = cost;
  }
  return best;
}

Steering VfhOpenings::step(const RobotState& robot, const geometry::Vector2& target, const PlacedScan& seen) {
  const auto refused = [this](std::string_view why) {
    reset();
    return Steering{Outcome::fault, why};
  };
  if (const std::string_view fault = fault_of(robot, target); !fault.empty()) return refused(fault);
  if (!std::isfinite(seen.laser.yaw)) return refused("it is not known where it was taken");
  if (!geometry::possible(seen.scan)) return refused("its angles or limits are none");
  OpeningBeams beams;
  if (const std::string_view fault = resample(seen.scan, beams); !fault.empty()) return refused(fault);

  const geometry::Vector2 way = target - robot.pose.position();
  const double bearing = way.isZero(0.0) ? robot.pose.yaw : std::atan2(way.y(), way.x());
  const auto in_beams = [&](double angle) { return 90.0 + geometry::angle_between(seen.laser.yaw, angle) / degree; };
  OpeningDirections directions{in_beams(bearing), in_beams(robot.pose.yaw), {}};
  if (before_) directions.before = in_beams(*before_);
  const std::optional<double> chosen = best_opening(openings_, beams, directions);
  if (!chosen) {
    if (searching_ == 0.0) searching_ = geometry::angle_between(robot.pose.yaw, bearing) < 0.0 ? -1.0 : 1.0;
    return {Outcome::hindered, "no opening is wide enough: it turns to find one", {0.0, searching_ * drive_.turn_rate}};
  }
  searching_ = 0.0;
  before_ = geometry::wrap_angle(seen.laser.yaw + (*chosen - 90.0) * degree);
  return {.twist = drive_in_direction(drive_, geometry::angle_between(robot.pose.yaw, *before_), way.norm())};
}

}  // namespace kervan::control
