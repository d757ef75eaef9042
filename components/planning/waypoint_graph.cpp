#include "components/planning/waypoint_graph.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace kervan::planning {

WaypointGraph::WaypointGraph(std::vector<geometry::Vector2> nodes) : nodes_(std::move(nodes)), edges_(nodes_.size()) {
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (!nodes_[i].allFinite()) throw std::invalid_argument("node " + std::to_string(i) + " is not a finite point");
}

void WaypointGraph::connect(std::size_t a, std::size_t b) {
  const bool exist = a < size() && b < size();
  connect(a, b, exist ? distance(a, b) : 0.0);
}

void WaypointGraph::connect(std::size_t a, std::size_t b, double cost) {
  for (const std::size_t node : {a, b}) {
    if (node < size()) continue;
    throw std::invalid_argument("node " + std::to_string(node) + " does not exist; there are " +
                                std::to_string(size()) + " nodes, counted from 0");
  }
  if (a == b) throw std::invalid_argument("node " + std::to_string(a) + " cannot be joined to itself");
  if (!(cost >= distance(a, b)))  // also true for NaN
    throw std::invalid_argument("the cost " + std::to_string(cost) + " m is less than the distance " +
                                std::to_string(distance(a, b)) + " m");
  set_edge(a, b, cost);
  set_edge(b, a, cost);
}

std::optional<std::size_t> WaypointGraph::nearest(const geometry::Vector2& point, double reach) const {
  std::optional<std::size_t> best;
  double best_distance = reach;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const double d = (nodes_[i] - point).norm();
    if (best ? d < best_distance : d <= best_distance) {
      best = i;
      best_distance = d;
    }
  }
  return best;
}

std::optional<std::pair<std::size_t, std::size_t>> WaypointGraph::nearest_edge(const geometry::Vector2& point,
                                                                               double reach) const {
  std::optional<std::pair<std::size_t, std::size_t>> best;
  double best_distance = reach;
  for (std::size_t a = 0; a < nodes_.size(); ++a) {
    for (const Edge& edge : edges_[a]) {
      if (edge.to < a) continue;
      const geometry::Vector2 along = nodes_[edge.to] - nodes_[a];
      const double length2 = along.squaredNorm();
      const double share = length2 > 0.0 ? std::clamp((point - nodes_[a]).dot(along) / length2, 0.0, 1.0) : 0.0;
      const double d = (point - nodes_[a] - share * along).norm();
      const std::pair found{a, edge.to};
      const bool better = best ? d < best_distance || (d == best_distance && found < *best) : d <= best_distance;
      if (!better) continue;
      best = found;
      best_distance = d;
    }
  }
  return best;
}

void WaypointGraph::set_edge(std::size_t from, std::size_t to, double cost) {
  auto& edges = edges_[from];
  const auto known = std::find_if(edges.begin(), edges.end(), [to](const Edge& edge) { return edge.to == to; });
  if (known != edges.end())
    known->cost = cost;
  else
    edges.push_back({to, cost});
}

}  // namespace kervan::planning
