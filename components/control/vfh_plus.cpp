#include "components/control/vfh_plus.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kervan::control {
namespace {

using geometry::Vector2;

constexpr double pi = std::numbers::pi;
constexpr double sector_width = 2.0 * pi / vfh_sectors;
constexpr double spread_step = 0.02;          // m
constexpr std::size_t most_remembered = 256;  // points
constexpr double apart = 0.04;                // m, between two that are remembered

int wrapped(int sector) {
  return sector < 0 ? sector + vfh_sectors : sector >= vfh_sectors ? sector - vfh_sectors : sector;
}

int sector_of(double angle) {
  return wrapped(static_cast<int>(std::floor(geometry::wrap_angle(angle) / sector_width)));
}

/// The sector of a direction by y / (|x| + |y|), which grows with the angle from -90 to 90 degrees: a tenth of what
/// atan2 takes, and exact to a thirtieth of a sector.
class SectorTable {
 public:
  SectorTable() {
    for (int i = 0; i <= steps; ++i) {
      const double slope = 2.0 * i / steps - 1.0;
      const double angle = std::atan2(slope, 1.0 - std::abs(slope));
      right_[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(sector_of(angle));
      left_[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(sector_of(pi - angle));
    }
  }
  /// Of a vector that is not zero.
  int operator()(const Vector2& v) const {
    const double slope = v.y() / (std::abs(v.x()) + std::abs(v.y()));
    const auto i = static_cast<std::size_t>((slope + 1.0) * (0.5 * steps) + 0.5);
    return v.x() >= 0.0 ? right_[i] : left_[i];
  }

 private:
  static constexpr int steps = 4096;
  std::array<std::uint8_t, steps + 1> right_{}, left_{};  // x >= 0, x < 0
};
static_assert(vfh_sectors <= 256);

const SectorTable table;

double turn_between(double from, double to) { return std::abs(geometry::angle_between(from, to)); }

}  // namespace

VfhPlus::VfhPlus(const VfhPlusParams& params, const HeadingDriveParams& drive) {
  set_params(params, drive);
  remembered_.reserve(most_remembered);
}

void VfhPlus::set_params(const VfhPlusParams& params, const HeadingDriveParams& drive) {
  params_ = params;
  drive_ = drive;
  keep_ = params.half_width + params.margin;
  spread_.clear();
  for (double d = 0.0; d <= params.look + spread_step; d += spread_step) {
    const double gamma = std::asin(std::min(1.0, keep_ / std::max(d, 1e-9)));
    spread_.push_back(static_cast<std::uint8_t>(std::lround(gamma / sector_width)));
  }
}

void VfhPlus::reset() {
  view_.blocked.fill(0);
  before_.reset();
  searching_ = 0.0;
}

void VfhPlus::use_beams(const geometry::Scan& scan) {
  if (beams_.size() == scan.ranges.size() && angle_min_ == scan.angle_min && angle_increment_ == scan.angle_increment)
    return;
  angle_min_ = scan.angle_min;
  angle_increment_ = scan.angle_increment;
  beams_.clear();
  for (std::size_t i = 0; i < scan.ranges.size(); ++i)
    beams_.push_back(geometry::heading(scan.angle_min + static_cast<double>(i) * scan.angle_increment));
  points_.reserve(beams_.size() + most_remembered);
  near_.reserve(beams_.size());
}

/// What the laser has seen and no longer looks at may still be there.
void VfhPlus::remember(const Vector2& robot, const PlacedScan& seen) {
  const double count = static_cast<double>(seen.scan.ranges.size()) - 1.0;
  const double half = 0.5 * std::abs(angle_increment_) * std::max(0.0, count) + 1e-6;
  const Vector2 middle = geometry::heading(seen.laser.yaw + angle_min_ + 0.5 * angle_increment_ * count);
  const double edge = half < pi ? std::cos(half) : -2.0;
  const auto over = [&](const Vector2& point) {
    const Vector2 from_laser = point - seen.laser.position();
    return from_laser.dot(middle) >= edge * from_laser.norm() || (point - robot).norm() > params_.remember;
  };
  std::erase_if(remembered_, over);
  for (const Vector2& point : near_) {
    if (over(point) || std::any_of(remembered_.begin(), remembered_.end(),
                                   [&](const Vector2& other) { return (other - point).squaredNorm() < apart * apart; }))
      continue;
    if (remembered_.size() == most_remembered) remembered_.erase(remembered_.begin());
    remembered_.push_back(point);
  }
}

void VfhPlus::gather(const Vector2& robot, const PlacedScan& seen) {
  const geometry::Scan& scan = seen.scan;
  points_.clear();
  near_.clear();
  for (const Vector2& point : remembered_) points_.push_back(point - robot);
  const double c = std::cos(seen.laser.yaw), s = std::sin(seen.laser.yaw);
  const Vector2 offset = seen.laser.position() - robot;
  const double farthest = std::min(scan.range_max, params_.look + offset.norm());
  const double look2 = params_.look * params_.look, remember2 = params_.remember * params_.remember;
  for (std::size_t i = 0; i < beams_.size(); ++i) {
    double range = static_cast<double>(scan.ranges[i]);
    if (range >= farthest) continue;
    if (!(range >= scan.range_min)) {
      if (range == -std::numeric_limits<double>::infinity()) {
        range = scan.range_min;
      } else {
        if (!(range >= 0.0)) ++refused_ranges_;
        continue;
      }
    }
    const Vector2 point =
        offset + range * Vector2(c * beams_[i].x() - s * beams_[i].y(), s * beams_[i].x() + c * beams_[i].y());
    const double d2 = point.squaredNorm();
    if (d2 >= look2) continue;
    points_.push_back(point);
    if (d2 < remember2) near_.push_back(point + robot);
  }
}

void VfhPlus::fill_histogram() {
  const auto none = static_cast<float>(params_.look);
  raw_.fill(none);
  for (const Vector2& point : points_) {
    float& nearest = raw_[static_cast<std::size_t>(point.isZero(0.0) ? 0 : table(point))];
    nearest = std::min(nearest, static_cast<float>(point.norm()));
  }
  // Twice round, so that no obstacle is spread over the end; folded together in the end.
  std::array<float, 2 * vfh_sectors> spread;
  spread.fill(none);
  constexpr int quarter = vfh_sectors / 4;
  for (int sector = 0; sector < vfh_sectors; ++sector) {
    const float d = raw_[static_cast<std::size_t>(sector)];
    if (d >= none) continue;
    const int half = spread_[static_cast<std::size_t>(static_cast<double>(d) / spread_step)];
    for (int i = sector + quarter - half; i <= sector + quarter + half; ++i)
      spread[static_cast<std::size_t>(i)] = std::min(spread[static_cast<std::size_t>(i)], d);
  }
  for (int sector = 0; sector < vfh_sectors; ++sector) {
    float d = spread[static_cast<std::size_t>(sector + quarter)];
    if (sector < quarter) d = std::min(d, spread[static_cast<std::size_t>(sector + quarter + vfh_sectors)]);
    if (sector >= vfh_sectors - quarter)
      d = std::min(d, spread[static_cast<std::size_t>(sector + quarter - vfh_sectors)]);
    const auto at = static_cast<std::size_t>(sector);
    view_.nearest[at] = d;
    if (static_cast<double>(d) < params_.block_within)
      view_.blocked[at] = 1;
    else if (static_cast<double>(d) > params_.free_beyond)
      view_.blocked[at] = 0;
  }
}

bool VfhPlus::open(const Vector2& way) const {
  const double length = way.norm();
  if (length > params_.look) return false;
  const Vector2 ahead = way / length;
  return std::none_of(points_.begin(), points_.end(), [&](const Vector2& point) {
    const double along = std::clamp(point.dot(ahead), 0.0, length);
    return (point - along * ahead).squaredNorm() < keep_ * keep_;
  });
}

std::optional<double> VfhPlus::choose(const RobotState& robot, const Vector2& way) const {
  const double target = std::atan2(way.y(), way.x());
  if (open(way)) return target;
  const auto blocked = [&](int sector) { return view_.blocked[static_cast<std::size_t>(wrapped(sector))] != 0; };
  int begin = 0;
  while (begin < vfh_sectors && !blocked(begin)) ++begin;
  if (begin == vfh_sectors) return target;

  std::optional<double> best;
  double least = 0.0;
  const auto consider = [&](double direction) {
    const double cost = params_.mu1 * turn_between(direction, target) +
                        params_.mu2 * turn_between(direction, robot.pose.yaw) +
                        params_.mu3 * (before_ ? turn_between(direction, *before_) : 0.0);
    if (best && cost >= least) return;
    best = direction;
    least = cost;
  };
  // Each valley from its right to its left, beginning behind a blocked sector.
  for (int right = begin + 1; right < begin + vfh_sectors; ++right) {
    if (blocked(right)) continue;
    int left = right;
    while (!blocked(left + 1)) ++left;
    const double width = (left - right + 1) * sector_width, from = right * sector_width;
    if (width <= params_.wide) {
      consider(geometry::wrap_angle(from + 0.5 * width));
    } else {
      const double room = 0.5 * params_.wide;
      const double at = std::remainder(target - (from + 0.5 * width), 2.0 * pi) + 0.5 * width;  // from the right edge
      consider(geometry::wrap_angle(from + room));
      consider(geometry::wrap_angle(from + width - room));
      if (at > room && at < width - room) consider(target);
    }
    right = left;
  }
  return best;
}

double VfhPlus::limited(double speed, double yaw, double error) const {
  const Vector2 ahead = geometry::heading(yaw);
  double room = params_.look, beside = params_.slow_within, turning = speed;
  for (const Vector2& point : points_) {
    const double x = point.dot(ahead), y = ahead.x() * point.y() - ahead.y() * point.x();
    const double off = std::abs(y) - params_.half_width;
    if (x > 0.0 && off < 0.5 * params_.margin) room = std::min(room, x - params_.nose - params_.stop_distance);
    if (off > 0.0 && std::abs(x) < params_.nose + beside) beside = std::min(beside, off);
    // Into a point between heading and direction goes a turn with a radius of more than (d² - R²) / 2 (R + y).
    const double inward = error > 0.0 ? y : -y;
    if (x > 0.0 && inward > 0.0 && inward < x * std::tan(std::min(std::abs(error), 1.5))) {
      const double most = (point.squaredNorm() - keep_ * keep_) / (2.0 * (keep_ + inward));
      turning = std::min(turning, drive_.turn_rate * std::max(0.0, most));
    }
  }
  const double share = params_.least_share + (1.0 - params_.least_share) * beside / params_.slow_within;
  return std::min({speed * std::min(1.0, share), turning, stopping_speed(room, drive_.braking, params_.delay)});
}

Steering VfhPlus::step(const RobotState& robot, const Vector2& target, const PlacedScan& seen) {
  const auto refused = [this](std::string_view why) {
    reset();
    return Steering{Outcome::fault, why};
  };
  if (const std::string_view fault = fault_of(robot, target); !fault.empty()) return refused(fault);
  if (!seen.laser.position().allFinite() || !std::isfinite(seen.laser.yaw))
    return refused("it is not known where it was taken");
  if (!geometry::possible(seen.scan)) return refused("its angles or limits are none");
  use_beams(seen.scan);
  remember(robot.pose.position(), seen);
  gather(robot.pose.position(), seen);
  fill_histogram();

  const Vector2 way = target - robot.pose.position();
  if (way.isZero(0.0)) return {};
  view_.direction = choose(robot, way);
  if (!view_.direction) {
    if (searching_ == 0.0)
      searching_ = geometry::angle_between(robot.pose.yaw, std::atan2(way.y(), way.x())) < 0.0 ? -1.0 : 1.0;
    return {Outcome::hindered,
            "all directions are blocked: it turns to find a free one",
            {0.0, searching_ * drive_.turn_rate}};
  }
  searching_ = 0.0;
  before_ = view_.direction;
  const double error = geometry::angle_between(robot.pose.yaw, *before_);
  geometry::Twist2 twist = drive_in_direction(drive_, error, way.norm());
  twist.linear = limited(twist.linear, robot.pose.yaw, error);
  return {.twist = twist};
}

}  // namespace kervan::control
