/// Notices that a robot is stuck, and gets it free by a fixed manoeuvre.
#pragma once

#include <optional>

#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::exploration {

struct StuckDetectorParams {
  double distance = 0.10;                   ///< m
  Duration time = std::chrono::seconds(4);  ///< commanded for so long it has moved less than that
};

/// Stuck: told to move for `time`, in one go or with pauses, the robot has not got `distance` away from where it was.
class StuckDetector {
 public:
  explicit StuckDetector(const StuckDetectorParams& params) : params_(params) {}

  /// Begins to watch anew: from the next look on.
  void reset() { place_.reset(); }

  /// The robot is at `position` and has been told to move, or not, since the last look. True if it is stuck.
  bool look(Time now, const geometry::Vector2& position, bool commanded);

 private:
  StuckDetectorParams params_;
  std::optional<geometry::Vector2> place_;
  Duration held_{};  ///< told to move while it stayed at that place
  Time looked_{};
};

struct BackOffParams {
  double distance = 0.5;    ///< m to back by
  double speed = 0.3;       ///< m/s
  double turn_rate = 0.75;  ///< rad/s
};

/// Backs in a straight line, then turns on the spot. What is in the way ends either part after twice the time that it
/// takes at its speed, and a second.
class BackOff {
 public:
  explicit BackOff(const BackOffParams& params) : params_(params) {}

  /// `turn`: rad, to the left if positive.
  void start(Time now, const geometry::Pose2& pose, double turn);
  bool active() const { return part_ != Part::none; }
  void stop() { part_ = Part::none; }

  /// What the robot, at `pose`, is to do now; nothing any more when the manoeuvre is over.
  std::optional<geometry::Twist2> step(Time now, const geometry::Pose2& pose);

 private:
  enum class Part { none, back, turn };

  BackOffParams params_;
  Part part_ = Part::none;
  double turn_ = 0.0;       ///< rad still to turn
  geometry::Pose2 last_{};  ///< where the part began; while it turns: at the last step
  Time until_{};
};

}  // namespace kervan::exploration
