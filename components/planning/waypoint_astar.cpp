#include "components/planning/waypoint_astar.hpp"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

namespace kervan::planning {
namespace {

constexpr std::size_t no_parent = std::numeric_limits<std::size_t>::max();

struct Open {
  double f = 0.0;
  double g = 0.0;
  std::size_t node = 0;

  /// std::priority_queue serves the largest element first.
  bool operator<(const Open& other) const { return f != other.f ? f > other.f : node > other.node; }
};

Route nothing(Outcome outcome, std::size_t expanded = 0) {
  Route route;
  route.outcome = outcome;
  route.expanded = expanded;
  return route;
}

Route trace_back(const WaypointGraph& graph, const std::vector<std::size_t>& parents, std::size_t goal) {
  Route route;
  route.outcome = Outcome::found;
  for (std::size_t node = goal; node != no_parent; node = parents[node]) route.nodes.push_back(node);
  std::reverse(route.nodes.begin(), route.nodes.end());
  for (std::size_t i = 1; i < route.nodes.size(); ++i)
    route.length += graph.distance(route.nodes[i - 1], route.nodes[i]);
  return route;
}

}  // namespace

Route find_route(const WaypointGraph& graph, std::size_t start, std::size_t goal) {
  if (start >= graph.size()) return nothing(Outcome::start_outside);
  if (goal >= graph.size()) return nothing(Outcome::goal_outside);

  std::vector<double> g(graph.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> parents(graph.size(), no_parent);
  std::priority_queue<Open> open;
  std::size_t expanded = 0;

  g[start] = 0.0;
  open.push({graph.distance(start, goal), 0.0, start});
  while (!open.empty()) {
    const Open current = open.top();
    open.pop();
    if (current.g > g[current.node]) continue;  // A cheaper way to this node was found after it had been queued.
    ++expanded;
    if (current.node == goal) {
      Route route = trace_back(graph, parents, goal);
      route.cost = g[goal];
      route.expanded = expanded;
      return route;
    }
    for (const auto& edge : graph.edges(current.node)) {
      const double through = current.g + edge.cost;
      if (through >= g[edge.to]) continue;
      g[edge.to] = through;
      parents[edge.to] = current.node;
      open.push({through + graph.distance(edge.to, goal), through, edge.to});
    }
  }
  return nothing(Outcome::no_path, expanded);
}

Route find_route(const WaypointGraph& graph, const geometry::Vector2& start, const geometry::Vector2& goal,
                 double reach) {
  const auto first = graph.nearest(start, reach);
  const auto edge = first ? std::nullopt : graph.nearest_edge(start, reach);
  if (!first && !edge) return nothing(Outcome::start_outside);
  const auto last = graph.nearest(goal, reach);
  if (!last) return nothing(Outcome::goal_outside);
  if (first) return find_route(graph, *first, *last);
  // Both ends lead to the goal or neither does.
  Route a = find_route(graph, edge->first, *last);
  Route b = find_route(graph, edge->second, *last);
  const double to_a = (graph.position(edge->first) - start).norm(),
               to_b = (graph.position(edge->second) - start).norm();
  return to_a + a.cost <= to_b + b.cost ? a : b;
}

}  // namespace kervan::planning
