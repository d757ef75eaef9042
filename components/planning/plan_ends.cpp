#include "components/planning/plan_ends.hpp"

#include "components/planning/line_walk.hpp"

namespace kervan::planning {
namespace {

using geometry::Vector2;
using Cell = GridSearch::Cell;

constexpr std::string_view start_no_number = "no route: where the robot is has a coordinate that is no number";
constexpr std::string_view goal_no_number = "no route: the goal has a coordinate that is no number";
constexpr std::string_view start_off_map = "no route: the robot is outside of the map";
constexpr std::string_view goal_off_map = "no route: the goal is outside of the map";
constexpr std::string_view start_in_obstacle =
    "no route: the robot is too near to an obstacle, and no free place is within its reach";
constexpr std::string_view goal_in_obstacle =
    "no route: the goal is too near to an obstacle, and so is all within its tolerance";

std::optional<Cell> cell_at(const Costmap& map, const Vector2& point) {
  if (!grid::has_cell(point) || map.box().empty()) return std::nullopt;
  const Vector2 at = map.to_cells(point);
  const Cell cell{static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y()))};
  if (!map.contains(cell.x, cell.y)) return std::nullopt;
  return cell;
}

std::optional<Place> way_out(const Costmap& map, const Vector2& from, double reach) {
  return nearest_free(map, from, reach, [&](const Cell& cell) {
    bool outside = false;
    return walk_line(from, middle_of(cell), [&](int x, int y, double) {
      const bool solid = map.weight(map.index(x, y)) == Costmap::occupied;
      outside = outside || !solid;
      return !(outside && solid);
    });
  });
}

}  // namespace

void refuse(Plan& plan, Outcome outcome, std::string_view why) {
  plan.outcome = outcome;
  plan.why = why;
  plan.points.clear();
  plan.headings.clear();
}

std::optional<PlanEnds> find_ends(const Costmap& map, const Query& query, Plan& plan) {
  plan.points.clear();
  plan.headings.clear();
  plan.length = plan.cost = plan.start_moved = plan.goal_moved = 0.0;
  plan.expanded = 0;
  const auto no = [&](Outcome outcome, std::string_view why) {
    refuse(plan, outcome, why);
    return std::nullopt;
  };
  if (!query.start.allFinite()) return no(Outcome::not_finite, start_no_number);
  if (!query.goal.allFinite()) return no(Outcome::not_finite, goal_no_number);
  const auto start_cell = cell_at(map, query.start), goal_cell = cell_at(map, query.goal);
  if (!start_cell) return no(Outcome::start_outside, start_off_map);
  if (!goal_cell) return no(Outcome::goal_outside, goal_off_map);

  std::optional<Place> start = Place{*start_cell, map.to_cells(query.start)};
  if (map.blocked(map.index(start_cell->x, start_cell->y)))
    start = way_out(map, start->point, query.escape / map.resolution());
  if (!start) return no(Outcome::start_occupied, start_in_obstacle);

  std::optional<Place> goal = Place{*goal_cell, map.to_cells(query.goal)};
  const bool goal_blocked = map.blocked(map.index(goal_cell->x, goal_cell->y));
  if (goal_blocked)
    goal = nearest_free(map, goal->point, query.tolerance / map.resolution(), [](const Cell&) { return true; });
  if (!goal) return no(Outcome::goal_occupied, goal_in_obstacle);
  return PlanEnds{*start, *goal, goal_blocked};
}

}  // namespace kervan::planning
