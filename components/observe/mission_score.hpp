/// Judges one robot's way to its goal, on the simulator's truth and never on the robot's own odometry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::observe {

struct MissionParams {
  std::vector<geometry::Vector2> goals;                 ///< m, map frame; to be reached in this order, at least one
  double tolerance = 0.10;                              ///< m, distance from a goal at which it counts as reached
  Duration timeout = std::chrono::seconds(90);          ///< for all goals together, after which the mission has failed
  double rest_speed = 0.005;                            ///< m/s, below which the robot stands
  double rest_turn = 0.01;                              ///< rad/s, the same for turning
  Duration rest_time = std::chrono::milliseconds(500);  ///< how long it must stand within the tolerance
  bool standing = true;       ///< whether it must stand at a goal; else it is enough to come within the tolerance
  bool contact_ends = false;  ///< whether the mission has failed when the robot has touched something
};

enum class MissionOutcome { running, reached, timed_out, given_up, touched };

/// The figures so far. Distances are in metres, between the robot's base_link and the goal it drives to, or drove to
/// last.
struct MissionFigures {
  MissionOutcome outcome = MissionOutcome::running;
  std::size_t goal = 0;  ///< number of that goal, from 0
  double time = 0.0;     ///< s from the start to the rest at the last goal, or to now
  double error = 0.0;    ///< from the last truth to the goal; 0 before the first
  double path = 0.0;     ///< length of the driven path
  double closest = 0.0;  ///< least distance to the goal; 0 before the first truth
  geometry::Vector2 closest_at = geometry::Vector2::Zero();  ///< where the robot was then
  std::uint32_t contacts = 0;
  std::optional<double> min_clearance;  ///< least distance between hull and world; none if it was never told
};

/// What a score needs to go on after its component was started again.
struct MissionMemory {
  Time start{};
  std::size_t goal = 0;
  double path = 0.0;  ///< m
  std::uint32_t contacts = 0;
  std::optional<double> min_clearance;  ///< m
};

/// A goal is reached by standing, for rest_time, within the tolerance; passing it counts only if that is asked for.
/// Standing elsewhere does not end the mission: only giving up and the time-out do, and contacts if that is asked for.
/// Once it has ended the figures no longer change.
class MissionScore {
 public:
  MissionScore(MissionParams params, Time start) : params_(std::move(params)), start_(start) {}

  /// Goes on where another one was; what happened in between is in the path only as a straight line, and not at all if
  /// it was never told. A goal that is not there any more counts as the last.
  MissionScore(MissionParams params, const MissionMemory& memory);

  MissionMemory memory() const;

  /// Where the robot is and how it moves at `now`, in the frame of the goals. Times must not go back.
  void truth(Time now, const geometry::Pose2& pose, const geometry::Twist2& twist);

  /// A contact has begun; `count` is that of the robot's contacts so far, this one included.
  void contact(std::uint32_t count);

  /// The distance between the robot's hull and the world, m.
  void clearance(double distance);

  /// The robot will not go on: ends the mission before its time.
  void give_up(Time now);

  /// Ends the mission when its time is up, even if no truth comes any more.
  void tick(Time now);

  const MissionFigures& figures() const { return figures_; }
  const geometry::Vector2& goal() const { return params_.goals.at(figures_.goal); }
  bool ended() const { return figures_.outcome != MissionOutcome::running; }

 private:
  MissionParams params_;
  Time start_;
  MissionFigures figures_;
  std::optional<geometry::Vector2> last_position_;
  bool approached_ = false;  // figures_.closest is of this goal
  std::optional<Time> at_rest_since_;
};

}  // namespace kervan::observe
