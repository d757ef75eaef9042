#include "components/localization/odometry_filter.hpp"

#include <Eigen/LU>
#include <cmath>

namespace kervan::localization {
namespace {

using geometry::Pose2;
using geometry::Vector2;

/// Wheels wear, loads change: what is known about the scales fades by this share of what was not known at first, per
/// square root of m.
constexpr double fading = 0.02;

}  // namespace

OdometryFilter::OdometryFilter(const OdometryFilterParams& params, const Pose2& start)
    : params_(params), origin_(start), pose_(start) {
  errors_(3, 3) = params.distance_error * params.distance_error;
  errors_(4, 4) = params.turn_error * params.turn_error;
}

OdometryResult OdometryFilter::odometry(Time stamp, const Pose2& odom) {
  if (!odom.position().allFinite() || !std::isfinite(odom.yaw)) return OdometryResult::refused_pose;
  if (!last_) {
    stamp_ = stamp;
    last_ = odom;
    pose_ = origin_ * odom;
    return OdometryResult::taken;
  }
  if (stamp <= stamp_ && stamp_ - stamp <= latest) return OdometryResult::refused_stamp;
  const bool anew = stamp < stamp_ || (odom.position() - last_->position()).norm() > farthest;
  stamp_ = stamp;
  if (anew) {
    last_ = odom;
    origin_ = pose_ * odom.inverse();
    return OdometryResult::began_anew;
  }
  move(odom);
  return OdometryResult::taken;
}

void OdometryFilter::move(const Pose2& odom) {
  if (odom == *last_) return;
  const Pose2 step = last_->inverse() * odom;
  const double c = std::cos(pose_.yaw), s = std::sin(pose_.yaw);
  const Vector2 by_wheels(c * step.x - s * step.y, s * step.x + c * step.y);  // in map
  const Vector2 moved = (1.0 + distance_scale_) * by_wheels;
  if (!corrected_) {
    pose_ = origin_ * odom;  // no sum of roundings
  } else {
    pose_.x += moved.x();
    pose_.y += moved.y();
    pose_.yaw = geometry::wrap_angle(pose_.yaw + (1.0 + turn_scale_) * step.yaw);
  }
  last_ = odom;

  Errors motion = Errors::Identity();
  motion(0, 2) = -moved.y();
  motion(1, 2) = moved.x();
  motion(0, 3) = by_wheels.x();
  motion(1, 3) = by_wheels.y();
  motion(2, 4) = step.yaw;
  errors_ = (motion * errors_ * motion.transpose()).eval();
  const double way = by_wheels.norm(), turn = std::abs(step.yaw), slip = params_.slip * params_.slip;
  errors_(0, 0) += slip * way;
  errors_(1, 1) += slip * way;
  errors_(2, 2) += slip * (way + turn);
  errors_(3, 3) += std::pow(fading * params_.distance_error, 2) * way;
  errors_(4, 4) += std::pow(fading * params_.turn_error, 2) * (way + turn);
}

void OdometryFilter::correct(const Eigen::Vector3d& offset, const Covariance& covariance) {
  corrected_ = true;
  const Covariance sum = errors_.topLeftCorner<3, 3>() + covariance;
  const Eigen::Matrix<double, 5, 3> gain = errors_.leftCols<3>() * sum.inverse();
  const Eigen::Matrix<double, 5, 1> change = gain * offset;
  pose_ = {pose_.x + change[0], pose_.y + change[1], geometry::wrap_angle(pose_.yaw + change[2])};
  distance_scale_ += change[3];
  turn_scale_ += change[4];
  const Errors rest = errors_ - gain * errors_.topRows<3>();
  errors_ = 0.5 * (rest + rest.transpose());
}

}  // namespace kervan::localization
