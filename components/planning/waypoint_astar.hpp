/// A* over a waypoint graph.
///
/// P. E. Hart, N. J. Nilsson, B. Raphael, "A Formal Basis for the Heuristic Determination of Minimum Cost Paths", IEEE
/// Trans. Systems Science and Cybernetics 4(2), 1968, doi:10.1109/TSSC.1968.300136. Used as the global planner by
/// Çınar, Parlaktuna and Yazıcı's comparison of potential field methods, whose own pseudo code is not A*: it never
/// improves a parent and stops when the goal is generated. This is the textbook algorithm; the difference is a unit
/// test.
#pragma once

#include <cstddef>
#include <vector>

#include "components/planning/planner.hpp"
#include "components/planning/waypoint_graph.hpp"

namespace kervan::planning {

struct Route {
  /// found, no_path, or start_outside and goal_outside: there is no such node, or none near enough.
  Outcome outcome = Outcome::no_path;
  std::vector<std::size_t> nodes;  ///< from start to goal, both included; empty unless found
  double cost = 0.0;               ///< m, sum of the edges' costs
  double length = 0.0;             ///< m, sum of the edges' lengths; equals cost on a graph without declared costs
  std::size_t expanded = 0;        ///< nodes taken from the open list
};

/// The cheapest route between two nodes. Among routes of equal cost the choice is fixed: of nodes with equal f the one
/// with the lower number is expanded first, so that equal graphs give equal routes.
Route find_route(const WaypointGraph& graph, std::size_t start, std::size_t goal);

/// The cheapest route between two points of the map frame. Each is mapped to the node nearest to it, at most `reach`
/// metres away. A start that is near no node, but at most `reach` from an edge, is on its way along it: the route
/// begins with that end of the edge over which it is cheaper, the way to it included. A point that is not finite is off
/// the graph.
Route find_route(const WaypointGraph& graph, const geometry::Vector2& start, const geometry::Vector2& goal,
                 double reach);

}  // namespace kervan::planning
