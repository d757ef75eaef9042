/// What every planner takes and gives, whatever it plans on: a graph of waypoints or a grid of cells.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "framework/geometry/pose2.hpp"

namespace kervan::planning {

enum class Outcome {
  found,
  no_path,         ///< start and goal are on the map but not connected
  start_occupied,  ///< and no free place is near enough to begin from
  goal_occupied,   ///< and no place near enough to it can be reached
  start_outside,   ///< of the map, or near no waypoint
  goal_outside,
  not_finite,  ///< a coordinate of start or goal is no number
  timeout,     ///< the search was given up; see Query::most_expanded
};

/// Points in the map's frame, m.
struct Query {
  geometry::Vector2 start = geometry::Vector2::Zero();
  geometry::Vector2 goal = geometry::Vector2::Zero();
  double escape = 0.0;     ///< m; a start that is occupied may be left in a straight line of at most this length
  double tolerance = 0.0;  ///< m; a goal that cannot be reached may be missed by this much
  /// rad, in the map's frame; for robots that cannot turn on the spot. Nothing: any will do.
  double start_heading = 0.0;
  std::optional<double> goal_heading = {};
  /// Nodes that the search may expand, or what the planner counts instead; 0: all. A number and not a time, so that the
  /// same query has the same answer on every machine, however busy it is.
  std::size_t most_expanded = 0;
};

struct Plan {
  Outcome outcome = Outcome::no_path;
  std::string_view why;                   ///< one sentence; empty if found; never changes once made
  std::vector<geometry::Vector2> points;  ///< from the start to where the plan ends, to be joined by straight lines
  std::vector<double> headings;           ///< rad, of the robot at each point; empty: it may turn on the spot
  double length = 0.0;                    ///< m, along the points
  double cost = 0.0;                      ///< m, dearer metres counted more; of the search, before it was straightened
  double start_moved = 0.0;               ///< m, from the start to the free place that the search began from
  double goal_moved = 0.0;                ///< m, from where the plan ends to the goal
  std::size_t expanded = 0;               ///< nodes whose neighbours were looked at
};

/// Finds a way from one point to another. It starts no thread. A query's answer depends on the query and the map alone,
/// unless the planner is one that is given a time and the query has no most_expanded.
class Planner {
 public:
  virtual ~Planner() = default;

  /// Overwrites `plan`, whose memory is used again.
  virtual void plan(const Query& query, Plan& plan) = 0;
};

}  // namespace kervan::planning
