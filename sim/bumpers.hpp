/// Bumpers: segments along the body that feel what they touch.
#pragma once

#include <vector>

#include "sim/robot_model.hpp"
#include "sim/surroundings.hpp"

namespace kervan::sim {

class Bumpers {
 public:
  /// The segments that `model` wears. One is pressed while anything is within `touch_range` (m) of it. Throws
  /// std::invalid_argument if that is not positive. `model` must be valid (require_valid).
  Bumpers(const RobotModel& model, double touch_range);

  std::size_t size() const { return segments_.size(); }
  const std::vector<Pose2>& segments() const {
    return segments_;
  }  ///< middles, in the body; the x axis points outwards
  double touch_range() const { return touch_range_; }

  /// Which segments something presses with the body at `pose`, into `pressed`: an obstacle, high or low, or another
  /// robot.
  void feel(const Surroundings& around, const Pose2& pose, std::vector<bool>& pressed) const;

 private:
  std::vector<Pose2> segments_;
  std::vector<Outline> pads_;  // the segments as thin bodies, in frames at their middles
  double touch_range_;
};

}  // namespace kervan::sim
