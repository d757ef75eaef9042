/// The cheapest way between two cells of a costmap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "components/planning/bucket_queue.hpp"
#include "components/planning/costmap.hpp"

namespace kervan::planning {

enum class SearchRule {
  all_neighbours,  ///< A* as in the textbook
  canonical,       ///< A* that looks at a neighbour only if the way over this cell may be the only cheapest one
  jump_point,      ///< jump point search; on uniform costs only
};

enum class Reached { goal, no_path, gave_up };

/// Moves lead to the eight neighbours, not past corners of blocked cells. A straight move into a cell costs 5741 times
/// its weight, a diagonal one 8119 times, which is sqrt(2) to 1e-8; costs are whole numbers, so that sums in any order
/// are equal. A* (Hart, Nilsson and Raphael 1968, doi:10.1109/TSSC.1968.300136) with the octile distance of the
/// lightest weight, in buckets of about a quarter of a cell, on labels that a new search outdates by their age instead
/// of clearing them.
///
/// Canonical ordering (Sturtevant and Rabin 2016, "Canonical Orderings on Grids", IJCAI): of the many cheapest ways
/// that differ in the order of their moves only the one is followed that moves diagonally first. What it leaves out can
/// be reached as cheaply round the cell within the nine cells around it, so it holds wherever these have one weight;
/// elsewhere all neighbours are looked at. Jump point search (Harabor and Grastien 2011, "Online Graph Pruning for
/// Pathfinding on Grid Maps", AAAI; 2014, "Improving Jump Point Search", ICAPS: blocks of cells at a time, and no stop
/// where a diagonal only turns) goes on in a straight line while there is one such neighbour.
class GridSearch {
 public:
  static constexpr std::uint64_t straight_cost = 5741;
  static constexpr std::uint64_t diagonal_cost = 8119;

  struct Cell {
    int x = 0;  ///< counted from 1, as in Costmap
    int y = 0;

    bool operator==(const Cell&) const = default;
  };

  /// Start and goal must be free. `most_expanded`: gives up after this many cells; 0: never. Jump points ask for a map
  /// with uniform costs.
  Reached find(const Costmap& map, Cell start, Cell goal, SearchRule rule, std::size_t most_expanded = 0);

  /// Of the last search, if it reached the goal.
  const std::vector<Cell>& path() const { return path_; }  ///< cell by cell, both ends included
  double cost() const { return cost_; }                    ///< in lengths of a cell

  std::size_t expanded() const { return expanded_; }

  /// True if the last search, which looked at all neighbours and found no path, came to this cell.
  bool came_to(std::uint32_t cell) const { return (labels_[cell] & age_bits) == age_; }

 private:
  /// A label, from its highest bits: 16 of age, which falls from search to search, 44 of the cost from the start, and
  /// the direction of the move into the cell. So one comparison says whether a new label is better, and any is better
  /// than one of an earlier search.
  using Label = std::uint64_t;
  static constexpr unsigned age_shift = 48, cost_shift = 4;
  static constexpr Label age_bits = ~Label{0} << age_shift;
  static constexpr Label direction_bits = 15;
  static constexpr unsigned from_nowhere = 8;  ///< direction of the start
  static constexpr std::uint64_t unknown_cost = ~std::uint64_t{0} >> 1;

  static std::uint64_t cost_of(Label label) { return (label & ~age_bits) >> cost_shift; }
  static unsigned direction_of(Label label) { return static_cast<unsigned>(label & direction_bits); }
  Label label(std::uint64_t cost, unsigned direction) const { return age_ | (cost << cost_shift) | direction; }

  std::uint64_t to_goal(std::uint32_t place) const;
  void begin(const Costmap& map, SearchRule rule);
  template <bool canonical>
  class Walk;
  template <bool canonical>
  Reached walk(const Costmap& map, std::size_t most_expanded);
  Reached jump(const Costmap& map, std::size_t most_expanded);
  void jump_straight(const Costmap& map, const BucketQueue::Entry& from, unsigned direction, std::uint64_t cost, int x,
                     int y);
  void jump_diagonally(const Costmap& map, const BucketQueue::Entry& from, unsigned direction, std::uint64_t cost);
  void reach(std::uint32_t parent, std::uint32_t cell, int x, int y, std::uint64_t cost, unsigned direction);
  void trace_steps(const Costmap& map);
  bool lies_open(const Costmap& map);
  void trace_jumps(const Costmap& map);

  std::vector<Label> labels_;
  std::vector<std::uint32_t> parents_;  // of jump points
  Label age_ = 0;
  BucketQueue open_;
  Cell start_, goal_;
  std::uint64_t goal_cost_ = 0;
  std::size_t expanded_ = 0;
  std::vector<Cell> path_;
  double cost_ = 0.0;
};

/// For a move that led into a cell, or `from_nowhere`, and the moves that the cell allows: those that have to be looked
/// at. In the first index 0 .. 7 are directions and 8 is the start.
const std::uint8_t* canonical_moves();

}  // namespace kervan::planning
