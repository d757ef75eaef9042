#include "components/planning/waypoint_astar.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <stdexcept>

namespace kervan::planning {
namespace {

using geometry::Vector2;
using Nodes = std::vector<std::size_t>;

// The laboratory of Çınar, Parlaktuna and Yazıcı: table 1's waypoints, and the adjacency that the paper does not print.
const std::vector<Vector2> lab_nodes{{0, 0},      {4.0, 3.0},   {5.0, 5.4},   {0.7, 9.1},  {11.5, 7.5},
                                     {16.0, 7.8}, {17.0, 3.0},  {15.2, 1.0},  {24.0, 0.7}, {30.4, 3.9},
                                     {30.8, 9.0}, {29.0, 15.8}, {15.7, 15.2}, {4.2, 15.7}};
const std::vector<std::pair<std::size_t, std::size_t>> lab_edges{{0, 1}, {1, 2},  {2, 3},   {2, 4},   {3, 13},
                                                                 {4, 5}, {5, 6},  {5, 12},  {6, 7},   {7, 8},
                                                                 {8, 9}, {9, 10}, {10, 11}, {11, 12}, {12, 13}};

WaypointGraph lab() {
  WaypointGraph graph(lab_nodes);
  for (const auto& [a, b] : lab_edges) graph.connect(a, b);
  return graph;
}

WaypointGraph fully_connected(const std::vector<Vector2>& nodes) {
  WaypointGraph graph(nodes);
  for (std::size_t a = 0; a < nodes.size(); ++a)
    for (std::size_t b = a + 1; b < nodes.size(); ++b) graph.connect(a, b);
  return graph;
}

// The search as the paper prints it: every node starts in OPEN, no node gets a better parent later, the successor with
// the lowest f over all of CLOSED is taken, the current node is pushed on one list of parents, and the search ends as
// soon as the goal is generated.
Nodes route_of_the_papers_pseudo_code(const WaypointGraph& graph, std::size_t start, std::size_t goal) {
  std::vector<double> g(graph.size(), 0.0);
  std::vector<bool> closed(graph.size(), false);
  closed[start] = true;
  Nodes parents{start};
  std::size_t current = start;
  for (;;) {
    for (const auto& edge : graph.edges(current)) {
      if (edge.to != goal) continue;
      parents.push_back(goal);
      return parents;
    }
    double best = std::numeric_limits<double>::infinity();
    std::size_t next = current;
    for (std::size_t node = 0; node < graph.size(); ++node) {
      if (!closed[node]) continue;
      for (const auto& edge : graph.edges(node)) {
        const double f = g[node] + edge.cost + graph.distance(edge.to, goal);
        if (closed[edge.to] || f >= best) continue;
        best = f;
        next = edge.to;
        g[next] = g[node] + edge.cost;
      }
    }
    if (next == current) return {};
    closed[next] = true;
    parents.push_back(next);
    current = next;
  }
}

double cheapest_by_relaxation(const WaypointGraph& graph, std::size_t start, std::size_t goal) {
  std::vector<double> g(graph.size(), std::numeric_limits<double>::infinity());
  g[start] = 0.0;
  for (std::size_t round = 0; round < graph.size(); ++round)
    for (std::size_t node = 0; node < graph.size(); ++node)
      for (const auto& edge : graph.edges(node)) g[edge.to] = std::min(g[edge.to], g[node] + edge.cost);
  return g[goal];
}

TEST(WaypointAstar, PlansThePrintedPathOnTheDeclaredAdjacency) {
  const Route route = find_route(lab(), 0, 5);
  EXPECT_EQ(route.outcome, Outcome::found);
  EXPECT_EQ(route.nodes, (Nodes{0, 1, 2, 4, 5}));
  EXPECT_NEAR(route.length, 18.941, 0.0005);
  EXPECT_DOUBLE_EQ(route.cost, route.length);
}

TEST(WaypointAstar, GoesStraightToTheGoalWhenFullyConnected) {
  const Route route = find_route(fully_connected(lab_nodes), 0, 5);
  EXPECT_EQ(route.nodes, (Nodes{0, 5}));
  EXPECT_NEAR(route.length, 17.800, 0.0005);
}

TEST(WaypointAstar, EstimatesWithTheStraightLineOfTheTable) {
  const double h[] = {17.800, 12.924, 11.259, 15.355, 4.510,  0.0,   4.903,
                      6.847,  10.696, 14.919, 14.849, 15.264, 7.406, 14.200};
  const WaypointGraph graph = lab();
  for (std::size_t node = 0; node < graph.size(); ++node) EXPECT_NEAR(graph.distance(node, 5), h[node], 0.0005) << node;
}

TEST(WaypointAstar, KnowsTheLengthsOfTheDeclaredEdges) {
  const double length[] = {5.000, 2.600, 5.673, 6.831, 7.471, 4.510,  4.903, 7.406,
                           2.691, 8.805, 7.155, 5.116, 7.034, 13.314, 11.511};
  const WaypointGraph graph = lab();
  for (std::size_t i = 0; i < lab_edges.size(); ++i)
    EXPECT_NEAR(graph.distance(lab_edges[i].first, lab_edges[i].second), length[i], 0.0005) << i;
}

TEST(WaypointAstar, ExpandsOnlyTheNodesThatCanLieOnTheWay) { EXPECT_EQ(find_route(lab(), 0, 5).expanded, 5u); }

TEST(WaypointAstar, PutsPositionsOnTheNearestNode) {
  const Route route = find_route(lab(), Vector2(0.3, -0.2), Vector2(15.9, 7.8), 1.0);
  EXPECT_EQ(route.nodes, (Nodes{0, 1, 2, 4, 5}));
}

TEST(WaypointAstar, SaysWhichEndIsOffTheGraph) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(find_route(lab(), Vector2(-2, 0), Vector2(16, 7.8), 1.0).outcome, Outcome::start_outside);
  EXPECT_EQ(find_route(lab(), Vector2(nan, 0), Vector2(16, 7.8), 1.0).outcome, Outcome::start_outside);
  EXPECT_EQ(find_route(lab(), Vector2(0, 0), Vector2(20, 11), 1.0).outcome, Outcome::goal_outside);
  EXPECT_EQ(find_route(lab(), 14, 5).outcome, Outcome::start_outside);
  EXPECT_EQ(find_route(lab(), 0, 14).outcome, Outcome::goal_outside);
  EXPECT_EQ(find_route(WaypointGraph({}), Vector2(0, 0), Vector2(1, 0), 1e9).outcome, Outcome::start_outside);
}

TEST(WaypointAstar, FindsNoPathBetweenSeparateParts) {
  WaypointGraph graph({{0, 0}, {1, 0}, {5, 0}, {6, 0}});
  graph.connect(0, 1);
  graph.connect(2, 3);
  const Route route = find_route(graph, 0, 3);
  EXPECT_EQ(route.outcome, Outcome::no_path);
  EXPECT_TRUE(route.nodes.empty());
  EXPECT_EQ(route.expanded, 2u);
}

TEST(WaypointAstar, IsThereAlreadyWhenStartAndGoalAreOneNode) {
  const Route route = find_route(lab(), 7, 7);
  EXPECT_EQ(route.outcome, Outcome::found);
  EXPECT_EQ(route.nodes, Nodes{7});
  EXPECT_EQ(route.length, 0.0);
}

TEST(WaypointAstar, AvoidsAnEdgeWithAHighCost) {
  WaypointGraph graph({{0, 0}, {2, 0.5}, {2, -1.5}, {4, 0}});
  graph.connect(0, 1, 9.0);  // slippery floor
  graph.connect(1, 3);
  graph.connect(0, 2);
  graph.connect(2, 3);
  const Route route = find_route(graph, 0, 3);
  EXPECT_EQ(route.nodes, (Nodes{0, 2, 3}));
  EXPECT_DOUBLE_EQ(route.length, 5.0);
}

TEST(WaypointAstar, FindsTheCheapestRouteOnRandomGraphs) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(0.0, 10.0), factor(1.0, 3.0);
  std::uniform_int_distribution<std::size_t> any_node(0, 29);
  for (int i = 0; i < 50; ++i) {
    std::vector<Vector2> nodes;
    for (int k = 0; k < 30; ++k) nodes.emplace_back(coordinate(random), coordinate(random));
    WaypointGraph graph(nodes);
    for (int k = 0; k < 60; ++k) {
      const std::size_t a = any_node(random), b = any_node(random);
      if (a != b) graph.connect(a, b, factor(random) * graph.distance(a, b));
    }
    const Route route = find_route(graph, 0, 1);
    const double cheapest = cheapest_by_relaxation(graph, 0, 1);
    if (route.outcome == Outcome::found)
      EXPECT_NEAR(route.cost, cheapest, 1e-9);
    else
      EXPECT_EQ(cheapest, std::numeric_limits<double>::infinity());
  }
}

TEST(WaypointAstar, ChoosesTheLowerNumberAmongEquals) {
  WaypointGraph graph({{0, 0}, {1, 1}, {1, -1}, {2, 0}});
  for (const std::size_t side : {2u, 1u}) {  // The order in which edges were declared does not matter.
    graph.connect(0, side);
    graph.connect(side, 3);
  }
  EXPECT_EQ(find_route(graph, 0, 3).nodes, (Nodes{0, 1, 3}));
}

TEST(PapersPseudoCode, FindsThePrintedPathInTheLaboratory) {
  EXPECT_EQ(route_of_the_papers_pseudo_code(lab(), 0, 5), (Nodes{0, 1, 2, 4, 5}));
}

TEST(PapersPseudoCode, TakesTheFirstEdgeToTheGoalThoughAnotherRouteIsCheaper) {
  WaypointGraph graph({{0, 0}, {2, 0.1}, {2, -1}, {4, 0}});
  graph.connect(0, 1);
  graph.connect(1, 3, 20.0);
  graph.connect(0, 2);
  graph.connect(2, 3);
  EXPECT_EQ(route_of_the_papers_pseudo_code(graph, 0, 3), (Nodes{0, 1, 3}));
  EXPECT_EQ(find_route(graph, 0, 3).nodes, (Nodes{0, 2, 3}));
}

TEST(PapersPseudoCode, KeepsADeadEndInItsListOfParents) {
  WaypointGraph graph({{0, 0}, {2, 0}, {0, 3}, {4, 3}, {4, 0}});
  graph.connect(0, 1);  // towards the goal, but no further
  graph.connect(0, 2);
  graph.connect(2, 3);
  graph.connect(3, 4);
  EXPECT_EQ(route_of_the_papers_pseudo_code(graph, 0, 4), (Nodes{0, 1, 2, 3, 4}));  // 1-2 is not even an edge
  EXPECT_EQ(find_route(graph, 0, 4).nodes, (Nodes{0, 2, 3, 4}));
}

TEST(WaypointGraph, RefusesWhatIsNoGraph) {
  WaypointGraph graph({{0, 0}, {3, 4}});
  EXPECT_THROW(graph.connect(0, 2), std::invalid_argument);
  EXPECT_THROW(graph.connect(1, 1), std::invalid_argument);
  EXPECT_THROW(graph.connect(0, 1, 4.9), std::invalid_argument);
  EXPECT_THROW(graph.connect(0, 1, std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  EXPECT_THROW(WaypointGraph({{0, std::numeric_limits<double>::infinity()}}), std::invalid_argument);
  EXPECT_TRUE(graph.edges(0).empty());
}

TEST(WaypointGraph, ReplacesTheCostOfAnEdgeThatIsJoinedAgain) {
  WaypointGraph graph({{0, 0}, {3, 4}});
  graph.connect(0, 1, 7.0);
  graph.connect(1, 0);
  ASSERT_EQ(graph.edges(0).size(), 1u);
  EXPECT_DOUBLE_EQ(graph.edges(0).front().cost, 5.0);
  EXPECT_DOUBLE_EQ(graph.edges(1).front().cost, 5.0);
}

TEST(WaypointGraph, FindsTheNearestNodeWithinReachOnly) {
  const WaypointGraph graph({{0, 0}, {2, 0}});
  EXPECT_EQ(graph.nearest({0.9, 0}, 5.0), 0u);
  EXPECT_EQ(graph.nearest({1.0, 0}, 5.0), 0u);
  EXPECT_EQ(graph.nearest({1.1, 0}, 5.0), 1u);
  EXPECT_EQ(graph.nearest({3.0, 0}, 1.0), 1u);
  EXPECT_EQ(graph.nearest({3.1, 0}, 1.0), std::nullopt);
}

TEST(WaypointAstar, BeginsOnAnEdgeWithTheEndOverWhichTheGoalIsNearer) {
  const WaypointGraph graph = lab();
  EXPECT_EQ(find_route(graph, Vector2(8.0, 6.4), Vector2(16.0, 7.8), 1.0).nodes, (Nodes{4, 5}));
  EXPECT_EQ(find_route(graph, Vector2(8.0, 6.4), Vector2(0.0, 0.0), 1.0).nodes, (Nodes{2, 1, 0}));
  EXPECT_EQ(find_route(graph, Vector2(8.0, 8.4), Vector2(16.0, 7.8), 1.0).outcome, Outcome::start_outside);
}

TEST(WaypointGraph, FindsTheNearestEdgeWithTheLowerNumbers) {
  WaypointGraph graph({{0, 0}, {4, 0}, {4, 2}, {0, 2}});
  graph.connect(2, 3);
  graph.connect(1, 0);
  EXPECT_EQ(graph.nearest_edge({2, 0.9}, 1.0), std::pair(std::size_t{0}, std::size_t{1}));
  EXPECT_EQ(graph.nearest_edge({2, 1.0}, 1.0), std::pair(std::size_t{0}, std::size_t{1})) << "equally near";
  EXPECT_EQ(graph.nearest_edge({2, 1.1}, 1.0), std::pair(std::size_t{2}, std::size_t{3}));
  EXPECT_FALSE(graph.nearest_edge({2, 3.1}, 1.0));
  EXPECT_FALSE(graph.nearest_edge({std::numeric_limits<double>::quiet_NaN(), 0}, 1.0));
}

}  // namespace
}  // namespace kervan::planning
