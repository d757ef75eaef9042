/// The dynamic window approach: of the speeds that a robot can have soon, the pair that leads best to its target and
/// can still be braked before every obstacle.
///
/// D. Fox, W. Burgard, S. Thrun, "The Dynamic Window Approach to Collision Avoidance", IEEE Robotics & Automation
/// Magazine 4(1), 1997, doi:10.1109/100.580977. As there, the search is over pairs (v, w) within reach of the
/// accelerations, and only pairs are admissible after which the robot can stop in time. Other than there, each pair is
/// driven in thought with the accelerations it takes to get there, the robot has its true outline, and what the
/// objective adds up (heading, clearance, speed) has one unit, the time to the target in seconds; so it needs no
/// weights between unlike things.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "components/control/control_law.hpp"
#include "components/control/seen_points.hpp"
#include "framework/geometry/pose2.hpp"
#include "framework/geometry/rectangular_hull.hpp"

namespace kervan::control {

/// The defaults are a Jackal's.
struct DwaParams {
  geometry::RectangularHull hull = {};
  double v_max = 1.2;              ///< m/s, forward
  double v_back = 0.3;             ///< m/s, backward; 0: it never drives backward
  double turn_rate = 2.0;          ///< rad/s
  double acceleration = 2.5;       ///< m/s2
  double deceleration = 2.5;       ///< m/s2
  double turn_acceleration = 6.0;  ///< rad/s2, speeding up and slowing down

  double period = 0.05;  ///< s, between two commands
  double delay = 0.1;    ///< s, from when pose and speed are measured to when the drive begins to follow the command
  double window = 0.4;   ///< s, within which a speed must be reachable to be thought of
  double horizon = 1.2;  ///< s, how far it is driven in thought

  double margin = 0.05;       ///< m; no admissible motion brings the hull nearer to a point
  double comfort = 0.30;      ///< m; room beyond this is as good as any
  double near_cost = 0.6;     ///< s, what a metre driven at the margin costs more than one with comfort
  double near_speed = 0.5;    ///< m/s, that is no haste at the margin; v_max is none with comfort
  double haste_cost = 1.0;    ///< s, what a metre driven in haste costs for each time as fast as that
  double detour_cost = 1.0;   ///< s, what it counts if the straight way to the target is blocked where a motion ends
  double turn_cost = 0.7;     ///< s, what each radian between the heading and the target counts
  double change_cost = 0.05;  ///< s, for a command that changes from one end of its range to the other
};

struct DwaStep : Steering {
  double clearance = 0.0;  ///< m, from the hull where the command takes effect; comfort, if there is more
  double cost = 0.0;       ///< s, of the motion chosen; infinite if none is admissible
};

class DynamicWindow {
 public:
  explicit DynamicWindow(const DwaParams& params);

  /// Other parameters from the next step on.
  void set_params(const DwaParams& params);

  /// One step, every period. `points` and `target` in the frame of the robot's pose. A fault if pose, twist or target
  /// is not finite; points are not asked. Hindered, and braking, if no motion is admissible.
  DwaStep step(const RobotState& robot, const geometry::Vector2& target, std::span<const SeenPoints::Point> points);

  /// The robot stands, whatever was commanded last.
  void reset() { last_ = {}; }

 private:
  struct State {
    float x = 0.0f, y = 0.0f, yaw = 0.0f;
    float v = 0.0f, w = 0.0f;
  };
  struct Spot {
    float x, y;
  };

  State predicted(const geometry::Twist2& speed) const;
  void drive(State& state, float v, float w, float time) const;
  void gather(const geometry::Pose2& at, std::span<const SeenPoints::Point> points);
  float clearance(const State& state) const;
  /// s to the target; infinity if the motion is not admissible.
  float cost(float v, float w) const;
  float time_left(const State& state) const;
  bool sees_target(const State& state, float dx, float dy, float distance) const;

  static constexpr int side = 28;           // bins around the robot, both ways
  static constexpr float bin_size = 0.25f;  // m

  DwaParams params_;
  geometry::Twist2 last_;  // commanded
  // Of the step at hand, in the frame of the robot when its command takes effect.
  State begin_;
  Spot target_{};
  float allowed_ = 0.0f;                               // m of clearance, on the way
  float wanted_ = 0.0f;                                // m of clearance, in the end, of a motion; 0: any
  std::vector<Spot> spots_;                            // bin by bin
  std::array<std::uint32_t, side * side + 1> bins_{};  // where the spots of a bin begin
  std::vector<std::uint32_t> bin_of_;
};

}  // namespace kervan::control
