/// Readings of a sensor that wait until it is known where the robot was when they were taken.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>

#include "framework/component/time.hpp"
#include "framework/geometry/pose_history.hpp"

namespace kervan::mapping {

/// Poses and readings come in any order; each reading leaves once, with the robot's pose at its stamp, in the order in
/// which they came.
template <class Reading>
class PosedReadings {
 public:
  /// A reading that is older than `max_age` when its turn comes is dropped: counted from `now`, the time at which it
  /// was published. `max_age` is also how far back poses are kept.
  explicit PosedReadings(Duration max_age) : max_age_(max_age), poses_(max_age) {}

  /// Where the robot was at `stamp`. A pose that is not finite is not taken, and counted; if the stamps jump back by
  /// more than max_age, their sender has begun anew, and so does this.
  void pose(Time stamp, const geometry::Pose2& pose) {
    if (!poses_.empty() && stamp + max_age_ < poses_.last()) poses_.clear();
    if (!poses_.add(stamp, pose) && !finite(pose)) ++bad_poses_;
  }

  /// `stamp`: when it was taken, on the clock of the poses' stamps; `received`: on that of release(). Of those that
  /// wait the oldest is dropped if there are too many.
  void reading(Time stamp, Time received, Reading reading) {
    if (waiting_.size() == most_waiting) {
      waiting_.pop_front();
      ++unplaced_;
    }
    waiting_.push_back({stamp, received, std::move(reading)});
  }

  /// Hands out what can be placed: use(pose, reading, stamp).
  template <class Use>
  void release(Time now, Use use) {
    while (!waiting_.empty()) {
      const Waiting& first = waiting_.front();
      if (now - first.received > max_age_ || (!poses_.empty() && poses_.last() - first.stamp > max_age_)) {
        ++late_;
      } else if (poses_.empty() || first.stamp > poses_.last()) {
        return;  // it may yet be told
      } else if (const auto pose = poses_.at(first.stamp)) {
        use(*pose, first.reading, first.stamp);
      } else {
        ++unplaced_;
      }
      waiting_.pop_front();
    }
  }

  bool has_pose() const { return !poses_.empty(); }
  std::uint64_t late() const { return late_; }            ///< older than max_age when they could be placed
  std::uint64_t unplaced() const { return unplaced_; }    ///< from before the first pose, or too many at once
  std::uint64_t bad_poses() const { return bad_poses_; }  ///< not finite

 private:
  static constexpr std::size_t most_waiting = 64;

  static bool finite(const geometry::Pose2& pose) { return pose.position().allFinite() && std::isfinite(pose.yaw); }

  struct Waiting {
    Time stamp;
    Time received;
    Reading reading;
  };

  Duration max_age_;
  geometry::PoseHistory poses_;
  std::deque<Waiting> waiting_;
  std::uint64_t late_ = 0;
  std::uint64_t unplaced_ = 0;
  std::uint64_t bad_poses_ = 0;
};

}  // namespace kervan::mapping
