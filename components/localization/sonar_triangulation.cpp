#include "components/localization/sonar_triangulation.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::localization {
namespace {

using geometry::Pose2;
using geometry::Vector2;

constexpr double least_error = 0.005;  // m, of a reading from nearby
constexpr double misfit = 1.5;         // mean square of what readings of one thing are off, of their variance
constexpr int steps = 4;               // of Gauss-Newton

}  // namespace

std::span<const SonarPoint> SonarTriangulation::round(const Pose2& odom, std::span<const SonarEcho> echoes,
                                                      const mapping::SonarLimits& limits) {
  points_.clear();
  tracks_.resize(echoes.size());
  const Pose2 to_robot = odom.inverse();
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    const SonarEcho& echo = echoes[i];
    if (std::isnan(echo.range)) continue;
    Track& track = tracks_[i];
    // What is as near as can be measured may be anything nearer.
    if (!(echo.range > limits.min_range && echo.range < limits.max_range && echo.range < params_.max_range)) {
      track.clear();
      continue;
    }
    const Reading reading{odom * echo.transducer, echo.range};
    if (!continues(track, reading)) track.clear();
    track.push_back(reading);
    shorten(track);
    if (const auto yaw = direction(track)) {
      // Of what is round the direction changes on the way: it is that of the middle.
      const Reading& middle = track[track.size() / 2];
      const Vector2 from = middle.transducer.position();
      points_.push_back({to_robot * from, to_robot * Vector2(from + middle.range * geometry::heading(*yaw))});
    }
  }
  return points_;
}

/// The distance to one thing changes by no more than the transducer moves.
bool SonarTriangulation::continues(const Track& track, const Reading& reading) const {
  if (track.empty()) return true;
  const Reading& last = track.back();
  const double moved = (reading.transducer.position() - last.transducer.position()).norm();
  const double error = 4.0 * params_.range_error * reading.range + 2.0 * least_error;
  return std::abs(reading.range - last.range) <= moved + error;
}

/// Forgets readings from too far back, and those whose cones have little in common with the last one's.
void SonarTriangulation::shorten(Track& track) const {
  const Pose2& now = track.back().transducer;
  while ((track.front().transducer.position() - now.position()).norm() > params_.stretch ||
         std::abs(geometry::angle_between(track.front().transducer.yaw, now.yaw)) > 1.6 * params_.half_aperture)
    track.pop_front();
}

/// In odom. Gauss-Newton for the direction n(θ) and the distance D of a line from the last transducer; from one that
/// stood at x as seen from there its distance is D - n·x. That θ is within all cones is a prior with the spread of an
/// even distribution.
std::optional<double> SonarTriangulation::direction(const Track& track) const {
  if (track.size() < params_.least_readings) return std::nullopt;
  const Pose2& now = track.back().transducer;
  const double range = track.back().range;
  double low = -params_.half_aperture, high = params_.half_aperture;  // from the last one's axis
  for (const Reading& reading : track) {
    const double off = geometry::angle_between(now.yaw, reading.transducer.yaw);
    low = std::max(low, off - params_.half_aperture);
    high = std::min(high, off + params_.half_aperture);
  }
  const double middle = 0.5 * (low + high), prior = 12.0 / ((high - low) * (high - low));
  const double error = params_.range_error * range + least_error, variance = error * error;
  const auto count = static_cast<double>(track.size());
  double theta = middle, information = 0.0, squares = 0.0;
  for (int step = 0; step < steps; ++step) {
    const Vector2 n = geometry::heading(now.yaw + theta), across(-n.y(), n.x());
    double distance = 0.0, mean_slope = 0.0;  // D, and what it changes by with θ
    for (const Reading& reading : track) {
      const Vector2 x = reading.transducer.position() - now.position();
      distance += (reading.range + n.dot(x)) / count;
      mean_slope += across.dot(x) / count;
    }
    double slopes = 0.0, product = 0.0;
    squares = 0.0;
    for (const Reading& reading : track) {
      const Vector2 x = reading.transducer.position() - now.position();
      const double off = reading.range + n.dot(x) - distance, slope = across.dot(x) - mean_slope;
      slopes += slope * slope;
      product += slope * off;
      squares += off * off;
    }
    information = slopes / variance + prior;
    theta -= (product / variance + prior * (theta - middle)) / information;
  }
  // A point in a direction that is off by δ lies r (1 - cos δ) before the wall.
  const bool certain = 0.5 * range / information <= params_.depth_error;
  if (!certain || theta < low || theta > high || squares > misfit * count * variance) return std::nullopt;
  return now.yaw + theta;
}

}  // namespace kervan::localization
