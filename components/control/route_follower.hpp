/// Hands out the waypoints of a route one after the other.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "framework/geometry/pose2.hpp"

namespace kervan::control {

struct RouteFollowerParams {
  double pass_within = 0.5;     ///< m; an intermediate waypoint counts as passed within this distance
  double arrive_within = 0.03;  ///< m; the last waypoint counts as reached within this distance
  /// m along the route, how far ahead of the robot the point is that it is to drive to; 0: it is the next waypoint.
  double look_ahead = 0.0;
  /// m; the point is so near that the straight line to it leaves the route by no more than this.
  double cut_corners = 0.1;
};

/// Keeps its place on a route: a waypoint once passed is not asked for again, and a route once finished stays finished
/// until the next one, even if the robot drifts away.
class RouteFollower {
 public:
  explicit RouteFollower(const RouteFollowerParams& params) : params_(params) {}

  /// Other distances from here on; what was passed stays passed.
  void set_params(const RouteFollowerParams& params) { params_ = params; }

  /// Starts a route from its first waypoint; points in metres, in the frame of the positions given to advance(). An
  /// empty route leaves nothing to do.
  void start(std::vector<geometry::Vector2> route);

  /// Enters the route where it passes `position` nearest, at the first such place: what lies before it is not driven
  /// any more. For a robot that is on its way already; one that stands before the first waypoint begins with that. A
  /// position that is not finite changes nothing.
  void join(const geometry::Vector2& position);

  /// Passes every waypoint that counts from `position`, several if they lie close together; with a look-ahead, those
  /// that lie behind the place on the route that is nearest to it. True if where to drive changed or the route was
  /// finished. A position that is not finite passes nothing.
  bool advance(const geometry::Vector2& position);

  /// Where to drive now; none before the first route and after an empty one. A finished route keeps its last waypoint.
  std::optional<geometry::Vector2> waypoint() const;

  /// Number of the current waypoint on the route, from 0.
  std::size_t index() const { return index_; }
  std::size_t size() const { return route_.size(); }
  bool arrived() const { return arrived_; }

 private:
  /// Where a leg passes a position nearest, from its waypoint `from` on.
  struct Foot {
    geometry::Vector2 at;
    double distance;
  };
  Foot foot(std::size_t from, const geometry::Vector2& position) const;
  geometry::Vector2 pass_legs(const geometry::Vector2& position);
  geometry::Vector2 point_ahead(const geometry::Vector2& position, const geometry::Vector2& on_route) const;
  bool straight_enough(const geometry::Vector2& from, const geometry::Vector2& to, std::size_t end) const;

  RouteFollowerParams params_;
  std::vector<geometry::Vector2> route_;
  std::size_t index_ = 0;
  bool arrived_ = false;
  std::optional<geometry::Vector2> ahead_;  // with a look-ahead, once a position is known
};

}  // namespace kervan::control
