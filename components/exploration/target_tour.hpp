/// Sends a robot from one random target to the next, and keeps count of how it does.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "components/exploration/target_draw.hpp"
#include "components/exploration/unsticking.hpp"
#include "components/exploration/visit_counter.hpp"
#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::exploration {

struct TargetTourParams {
  std::uint64_t seed = 1;
  std::optional<Area> area;                      ///< where targets lie; none: around all obstacles
  double room = 0.5;                             ///< m, from a target to the nearest obstacle at least
  double arrive_within = 0.4;                    ///< m; a target is reached by a robot this near to it
  Duration patience = std::chrono::seconds(60);  ///< a target not reached by then is replaced by the next
  VisitCounterParams visits;
  StuckDetectorParams stuck;
  BackOffParams back_off;
  double least_turn = 1.5707963;  ///< rad; a robot that was stuck turns to either side, from this to half a turn
};

struct TourFigures {
  std::uint64_t points = 0;   ///< of its routes that the robot visited
  std::uint64_t stuck = 0;    ///< times that it was stuck
  std::uint64_t targets = 0;  ///< given
  std::uint64_t reached = 0;
  std::uint64_t unreachable = 0;               ///< given up by the planner
  std::uint64_t late = 0;                      ///< not reached in time
  std::optional<Duration> first_reached = {};  ///< after the first target was given
  double path = 0.0;                           ///< m driven
};

/// Every target is left behind when it is reached, when the planner gives it up, when its time is over, and when the
/// robot is stuck: then it backs, turns, and gets the next one. Target k and turn k depend on the seed and k alone, so
/// robots that drive differently get the same ones.
class TargetTour {
 public:
  explicit TargetTour(const TargetTourParams& params)
      : params_(params), visits_(params.visits), detector_(params.stuck), back_off_(params.back_off) {}

  /// What targets keep away from, from the next one on.
  void surround(Obstacles obstacles) { obstacles_ = std::move(obstacles); }

  /// The route to the present target, from where the robot is; empty: none.
  void route(std::span<const geometry::Vector2> points) { visits_.route(points); }

  /// The planner says that the present target cannot be reached.
  void give_up();

  enum class Event { none, new_target, stuck, no_target };
  /// The robot is at `pose`, finite, and has been told to move, or not, since the last step. `new_target`: target() is
  /// another one. `stuck`: the robot has just been found to be. `no_target`: there is no area, or no place in it has
  /// room.
  Event step(Time now, const geometry::Pose2& pose, bool commanded);

  const std::optional<geometry::Vector2>& target() const { return target_; }
  /// What a robot that is being got free is to do, whatever its controller says.
  const std::optional<geometry::Twist2>& manoeuvre() const { return manoeuvre_; }
  const TourFigures& figures() const { return figures_; }

 private:
  Event next_target(Time now, const geometry::Vector2& position);

  TargetTourParams params_;
  Obstacles obstacles_;
  VisitCounter visits_;
  StuckDetector detector_;
  BackOff back_off_;
  std::optional<geometry::Vector2> target_;
  std::optional<geometry::Twist2> manoeuvre_;
  Time given_{};                           ///< the present target
  std::optional<Time> first_given_;        ///< the first one
  std::optional<geometry::Vector2> last_;  ///< where the robot was
  TourFigures figures_;
};

}  // namespace kervan::exploration
