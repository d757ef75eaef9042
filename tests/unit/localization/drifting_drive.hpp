/// A drive through a room with wheels that err, for tests of localizers.
#pragma once

#include <utility>
#include <vector>

#include "framework/component/time.hpp"
#include "tests/unit/localization/drawn_map.hpp"

namespace kervan::localization {

using Walls = std::vector<std::pair<geometry::Vector2, geometry::Vector2>>;

/// A room that looks the same from nowhere else. Its straight walls run through the middles of cells.
inline const Walls room = {{{-2.975, -2.475}, {2.975, -2.475}}, {{2.975, -2.475}, {2.975, 2.475}},
                           {{2.975, 2.475}, {-2.975, 2.475}},   {{-2.975, 2.475}, {-2.975, -2.475}},
                           {{-2.975, 0.525}, {-1.7, 0.525}},    {{1.0, 2.475}, {1.4, 1.5}}};

/// Circles through the room, 0.05 m a step; begins where odom and map are one.
class DriftingDrive {
 public:
  DriftingDrive(double distance_scale, double turn_scale) : distance_scale_(distance_scale), turn_scale_(turn_scale) {}

  void step() {
    constexpr double way = 0.05, turn = 0.05 / 1.3;
    truth_ = truth_ * geometry::Pose2{way, 0.0, turn};
    odom_ = odom_ * geometry::Pose2{distance_scale_ * way, 0.0, turn_scale_ * turn};
    now_ += std::chrono::milliseconds(100);
  }

  const geometry::Pose2& truth() const { return truth_; }
  const geometry::Pose2& odom() const { return odom_; }
  Time now() const { return now_; }

  double error_of(const geometry::Pose2& pose) const { return (pose.position() - truth_.position()).norm(); }

 private:
  double distance_scale_, turn_scale_;
  geometry::Pose2 truth_{0.0, -1.3, 0.0}, odom_ = truth_;
  Time now_{};
};

}  // namespace kervan::localization
