/// A graph of places a robot can drive between in a straight line.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "framework/geometry/pose2.hpp"

namespace kervan::planning {

/// Nodes are points of the map frame (m), numbered from 0. Edges are undirected and carry a cost in metres.
class WaypointGraph {
 public:
  struct Edge {
    std::size_t to = 0;
    double cost = 0.0;  ///< m; never less than the distance between the two nodes
  };

  /// Throws std::invalid_argument if a coordinate is not finite. An empty graph is allowed; nothing is found on it.
  explicit WaypointGraph(std::vector<geometry::Vector2> nodes);

  /// Joins two nodes at the cost of their distance. Joining them again replaces the cost.
  /// Throws std::invalid_argument if a node does not exist or both are the same.
  void connect(std::size_t a, std::size_t b);

  /// As above with a cost in metres. A cost below the distance is refused too, because it would make the straight line
  /// an overestimate and A* could then return a path that is not the cheapest.
  void connect(std::size_t a, std::size_t b, double cost);

  std::size_t size() const { return nodes_.size(); }
  const geometry::Vector2& position(std::size_t node) const { return nodes_.at(node); }
  const std::vector<Edge>& edges(std::size_t node) const { return edges_.at(node); }  ///< in the order of connect()
  double distance(std::size_t a, std::size_t b) const { return (position(a) - position(b)).norm(); }

  /// The node nearest to `point`, the lower number if two are equally near; none if no node lies within `reach` metres
  /// or the point is not finite.
  std::optional<std::size_t> nearest(const geometry::Vector2& point, double reach) const;

  /// The edge nearest to `point`, as its two nodes with the lower number first; the one with the lower numbers if two
  /// are equally near; none if no edge passes within `reach` metres or the point is not finite.
  std::optional<std::pair<std::size_t, std::size_t>> nearest_edge(const geometry::Vector2& point, double reach) const;

 private:
  void set_edge(std::size_t from, std::size_t to, double cost);

  std::vector<geometry::Vector2> nodes_;
  std::vector<std::vector<Edge>> edges_;
};

}  // namespace kervan::planning
