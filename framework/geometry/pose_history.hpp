/// Where a body was at a time, from the poses that were told of it.
#pragma once

#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>

#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::geometry {

/// Between two poses it moves evenly along the straight line and turns evenly the short way.
inline Pose2 between(const Pose2& from, const Pose2& to, double share) {
  return {from.x + share * (to.x - from.x), from.y + share * (to.y - from.y),
          wrap_angle(from.yaw + share * angle_between(from.yaw, to.yaw))};
}

/// Keeps the poses of the last `length`.
class PoseHistory {
 public:
  explicit PoseHistory(Duration length) : length_(length) {}

  /// Times must grow; a pose that is not finite, or not later than the last one, is not taken (false).
  bool add(Time time, const Pose2& pose) {
    if (!pose.position().allFinite() || !std::isfinite(pose.yaw)) return false;
    if (!poses_.empty() && time <= poses_.back().time) return false;
    poses_.push_back({time, pose});
    // One at or before the beginning stays, for what lies between it and the next.
    while (poses_.size() > 1 && poses_[1].time + length_ <= time) poses_.pop_front();
    return true;
  }

  /// Whoever sends the poses has begun anew, at an earlier time.
  void clear() { poses_.clear(); }

  bool empty() const { return poses_.empty(); }
  Time first() const { return poses_.front().time; }  ///< if not empty
  Time last() const { return poses_.back().time; }

  /// Nothing before the first and after the last pose: nobody is asked to guess.
  std::optional<Pose2> at(Time time) const {
    if (poses_.empty() || time < first() || time > last()) return std::nullopt;
    std::size_t next = poses_.size() - 1;  // they are few, and the newest are asked for
    while (next > 0 && poses_[next - 1].time >= time) --next;
    if (poses_[next].time == time) return poses_[next].pose;
    const Timed &a = poses_[next - 1], &b = poses_[next];
    return between(a.pose, b.pose, seconds(time - a.time) / seconds(b.time - a.time));
  }

 private:
  struct Timed {
    Time time;
    Pose2 pose;
  };

  Duration length_;
  std::deque<Timed> poses_;
};

}  // namespace kervan::geometry
