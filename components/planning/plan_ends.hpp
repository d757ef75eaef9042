/// Where plans on a costmap begin and end, and what is said when they cannot.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "components/planning/costmap.hpp"
#include "components/planning/grid_search.hpp"
#include "components/planning/planner.hpp"

namespace kervan::planning {

inline constexpr std::string_view goal_cut_off =
    "no route: the goal is too near to an obstacle, and what is free within its tolerance cannot be reached";
inline constexpr std::string_view not_connected = "no route: no free way leads from the robot to the goal";

inline geometry::Vector2 middle_of(const GridSearch::Cell& cell) { return {cell.x + 0.5, cell.y + 0.5}; }

struct Place {
  GridSearch::Cell cell;
  geometry::Vector2 point;  ///< in cells, as Costmap::to_cells()
  double moved = 0.0;       ///< cells, from where it was wanted
};

/// Both are free.
struct PlanEnds {
  Place start, goal;
  bool goal_blocked = false;  ///< the goal of the query is; `goal` is near it
};

/// The plan has no points then.
void refuse(Plan& plan, Outcome outcome, std::string_view why);

/// Empties the plan and finds where it has to begin and end: at the query's start and goal if they are free, else
/// where its escape leads to and the nearest free place within its tolerance. A robot that is too near to an obstacle
/// may leave through places that are too near as well, and, if the map has it inside of one, out of that; but not into
/// another. Nothing, and the plan says why, if there is no such place.
std::optional<PlanEnds> find_ends(const Costmap& map, const Query& query, Plan& plan);

/// Of the cells whose middles are at most `reach` cells away, the nearest that is free and good; of several the lowest,
/// and of these the left one.
template <class Good>
std::optional<Place> nearest_free(const Costmap& map, const geometry::Vector2& to, double reach, const Good& good) {
  std::optional<Place> best;
  const auto low = [](double at) { return std::max(1, static_cast<int>(std::floor(at))); };
  const int right = std::min(map.columns(), static_cast<int>(to.x() + reach)),
            top = std::min(map.rows(), static_cast<int>(to.y() + reach));
  for (int y = low(to.y() - reach); y <= top; ++y)
    for (int x = low(to.x() - reach); x <= right; ++x) {
      const double moved = (middle_of({x, y}) - to).norm();
      if (moved > (best ? best->moved : reach) || (best && moved == best->moved)) continue;
      if (!map.blocked(map.index(x, y)) && good(GridSearch::Cell{x, y})) best = Place{{x, y}, middle_of({x, y}), moved};
    }
  return best;
}

}  // namespace kervan::planning
