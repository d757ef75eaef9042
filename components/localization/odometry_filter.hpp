/// Where a robot is by its wheels, how sure that is, and what others teach about the wheels.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::localization {

/// Over x, y (m) in map and yaw (rad).
using Covariance = Eigen::Matrix3d;

struct OdometryFilterParams {
  /// Standard deviation of the wheels' scale errors, which stay what they are for a run: m per m and rad per rad. A
  /// bound of b, within which every value is as likely, has b / sqrt(3).
  double distance_error = 0.02;
  double turn_error = 0.02;
  /// Standard deviation of what is new at every step, slip and uneven ground: m per square root of m, and rad per
  /// square root of m and of rad.
  double slip = 0.003;
};

enum class OdometryResult {
  taken,
  began_anew,     ///< it cannot go on from the last one, by time or place: the robot is taken to stand where it stood
  refused_pose,   ///< not finite
  refused_stamp,  ///< not newer than the last one
};

/// Dead reckoning with the first-order propagation of its errors; an extended Kalman filter over pose and scale errors
/// as soon as it is corrected (Borenstein and Feng 1996, "Measurement and correction of systematic odometry errors in
/// mobile robots", doi:10.1109/70.544770, names the errors; Thrun, Burgard and Fox 2005, "Probabilistic Robotics",
/// section 3.3, the filter). Without corrections the pose is exactly what the wheels say.
class OdometryFilter {
 public:
  /// `start`: pose in map of the frame that odometry is told in.
  OdometryFilter(const OdometryFilterParams& params, const geometry::Pose2& start);

  /// base_link in odom at `stamp`.
  OdometryResult odometry(Time stamp, const geometry::Pose2& odom);

  /// The pose, of which there must be one, is off by `offset` (x, y, yaw), which is known with `covariance`.
  void correct(const Eigen::Vector3d& offset, const Covariance& covariance);

  bool has_odometry() const { return last_.has_value(); }
  const geometry::Pose2& pose() const { return pose_; }  ///< of base_link in map
  Covariance covariance() const { return errors_.topLeftCorner<3, 3>(); }

  /// The frame odom in map, as of now.
  geometry::Pose2 map_to_odom() const { return corrected_ ? pose_ * last_->inverse() : origin_; }

  /// What a metre and a radian of the wheels' really are, less 1, as far as it has been learned.
  double distance_scale() const { return distance_scale_; }
  double turn_scale() const { return turn_scale_; }

  /// Wheels do not move farther than this between two poses, m; nor are samples older than this among newer ones.
  static constexpr double farthest = 2.0;
  static constexpr Duration latest = std::chrono::seconds(1);

 private:
  void move(const geometry::Pose2& odom);

  using Errors = Eigen::Matrix<double, 5, 5>;  // x, y, yaw, distance scale, turn scale

  OdometryFilterParams params_;
  geometry::Pose2 origin_;  // of odom in map, as long as nothing was corrected
  bool corrected_ = false;
  std::optional<geometry::Pose2> last_;  // in odom
  Time stamp_{};
  geometry::Pose2 pose_;
  double distance_scale_ = 0.0;
  double turn_scale_ = 0.0;
  Errors errors_ = Errors::Zero();
};

}  // namespace kervan::localization
