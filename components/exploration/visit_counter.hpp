/// Counts how many points of its routes a robot gets to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "framework/geometry/pose2.hpp"

namespace kervan::exploration {

struct VisitCounterParams {
  double spacing = 1.0;  ///< m, along a route from one point to the next
  double within = 0.4;   ///< m; a point is visited when the robot is this near to it
};

/// "Points visited" of the paper on search and rescue with vector field histograms, which does not define them: points
/// lie on the route to a target, one each `spacing`, from where the robot was when it got the target. A point that is
/// passed over counts no more once a later one was visited.
///
/// When a route is replaced on the way to the same target, the first point of the new one is where it gets `spacing`
/// away from the last point visited: so planning anew, however often, brings no point nearer and takes none away.
class VisitCounter {
 public:
  explicit VisitCounter(const VisitCounterParams& params) : params_(params) {}

  /// The robot, at `position`, has got a target; the route to it is still to come.
  void begin(const geometry::Vector2& position);

  /// The route from here on, from where the robot is to the target; points that are joined by straight lines. Empty:
  /// there is none any more.
  void route(std::span<const geometry::Vector2> points);

  /// The robot is at `position`. True if it has come to a point.
  bool look(const geometry::Vector2& position);

  std::uint64_t visited() const { return visited_; }
  /// Those of the present route that are still to be visited.
  std::span<const geometry::Vector2> ahead() const { return points_; }

 private:
  VisitCounterParams params_;
  geometry::Vector2 last_ = geometry::Vector2::Zero();  ///< point visited, or where the target was given
  std::vector<geometry::Vector2> points_;
  std::uint64_t visited_ = 0;
};

}  // namespace kervan::exploration
