#include "components/planning/grid_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "components/planning/line_walk.hpp"

namespace kervan::planning {
namespace {

using geometry::Vector2;

constexpr std::string_view start_no_number = "no route: where the robot is has a coordinate that is no number";
constexpr std::string_view goal_no_number = "no route: the goal has a coordinate that is no number";
constexpr std::string_view start_off_map = "no route: the robot is outside of the map";
constexpr std::string_view goal_off_map = "no route: the goal is outside of the map";
constexpr std::string_view start_in_obstacle =
    "no route: the robot is too near to an obstacle, and no free place is within its reach";
constexpr std::string_view goal_in_obstacle =
    "no route: the goal is too near to an obstacle, and so is all within its tolerance";
constexpr std::string_view goal_cut_off =
    "no route: the goal is too near to an obstacle, and what is free within its tolerance cannot be reached";
constexpr std::string_view not_connected = "no route: no free way leads from the robot to the goal";
constexpr std::string_view gave_up = "no route: the search was given up, it looked at as many cells as it may";

Vector2 middle_of(const GridSearch::Cell& cell) { return {cell.x + 0.5, cell.y + 0.5}; }

void refuse(Plan& plan, Outcome outcome, std::string_view why) {
  plan.outcome = outcome;
  plan.why = why;
}

}  // namespace

std::optional<GridPlanner::Cell> GridPlanner::cell_at(const Vector2& point) const {
  if (!grid::has_cell(point) || map_.box().empty()) return std::nullopt;
  const Vector2 at = map_.to_cells(point);
  const Cell cell{static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y()))};
  if (!map_.contains(cell.x, cell.y)) return std::nullopt;
  return cell;
}

GridPlanner::Place GridPlanner::exactly(const Cell& cell, const Vector2& point) const {
  return {cell, map_.to_cells(point), 0.0};
}

/// Of the cells whose middles are at most `reach` cells away, the nearest that is free and good; of several the lowest,
/// and of these the left one.
template <class Good>
std::optional<GridPlanner::Place> GridPlanner::nearest(const Vector2& to, double reach, const Good& good) const {
  std::optional<Place> best;
  const auto low = [](double at) { return std::max(1, static_cast<int>(std::floor(at))); };
  const int right = std::min(map_.columns(), static_cast<int>(to.x() + reach)),
            top = std::min(map_.rows(), static_cast<int>(to.y() + reach));
  for (int y = low(to.y() - reach); y <= top; ++y)
    for (int x = low(to.x() - reach); x <= right; ++x) {
      const double moved = (middle_of({x, y}) - to).norm();
      if (moved > (best ? best->moved : reach) || (best && moved == best->moved)) continue;
      if (!map_.blocked(map_.index(x, y)) && good(Cell{x, y})) best = Place{{x, y}, middle_of({x, y}), moved};
    }
  return best;
}

/// A robot that is too near to an obstacle may leave through places that are too near as well, and, if the map has it
/// inside of one, out of that; but not into another.
std::optional<GridPlanner::Place> GridPlanner::way_out(const Vector2& from, double reach) const {
  return nearest(from, reach, [&](const Cell& cell) {
    bool outside = false;
    return walk_line(from, middle_of(cell), [&](int x, int y, double) {
      const bool solid = map_.weight(map_.index(x, y)) == Costmap::occupied;
      outside = outside || !solid;
      return !(outside && solid);
    });
  });
}

SearchRule GridPlanner::rule() const {
  switch (params_.search) {
    case SearchChoice::automatic: return map_.uniform() ? SearchRule::jump_point : SearchRule::canonical;
    case SearchChoice::all_neighbours: return SearchRule::all_neighbours;
    case SearchChoice::canonical: return SearchRule::canonical;
    case SearchChoice::jump_point: return SearchRule::jump_point;
  }
  return SearchRule::canonical;
}

/// Counts what it expanded; all searches of a plan together may not expand more than the query allows.
Reached GridPlanner::search(const Query& query, const Place& start, const Place& goal, SearchRule rule, Plan& plan) {
  std::size_t most = 0;
  if (query.most_expanded != 0) {
    if (plan.expanded >= query.most_expanded) return Reached::gave_up;
    most = query.most_expanded - plan.expanded;
  }
  const Reached reached = search_.find(map_, start.cell, goal.cell, rule, most);
  plan.expanded += search_.expanded();
  return reached;
}

void GridPlanner::plan(const Query& query, Plan& plan) {
  plan.points.clear();
  plan.length = plan.cost = plan.start_moved = plan.goal_moved = 0.0;
  plan.expanded = 0;
  if (!query.start.allFinite()) return refuse(plan, Outcome::not_finite, start_no_number);
  if (!query.goal.allFinite()) return refuse(plan, Outcome::not_finite, goal_no_number);
  const auto start_cell = cell_at(query.start), goal_cell = cell_at(query.goal);
  if (!start_cell) return refuse(plan, Outcome::start_outside, start_off_map);
  if (!goal_cell) return refuse(plan, Outcome::goal_outside, goal_off_map);

  std::optional<Place> start = exactly(*start_cell, query.start);
  if (map_.blocked(map_.index(start_cell->x, start_cell->y)))
    start = way_out(map_.to_cells(query.start), query.escape / map_.resolution());
  if (!start) return refuse(plan, Outcome::start_occupied, start_in_obstacle);

  const double tolerance = query.tolerance / map_.resolution();
  const Vector2 wanted = map_.to_cells(query.goal);
  std::optional<Place> goal = exactly(*goal_cell, query.goal);
  const bool goal_blocked = map_.blocked(map_.index(goal_cell->x, goal_cell->y));
  if (goal_blocked) goal = nearest(wanted, tolerance, [](const Cell&) { return true; });
  if (!goal) return refuse(plan, Outcome::goal_occupied, goal_in_obstacle);

  Reached reached = search(query, *start, *goal, rule(), plan);
  if (reached == Reached::no_path && tolerance > 0.0) {
    // What can be reached at all is what a search that looks at all neighbours came to.
    if (rule() != SearchRule::all_neighbours) reached = search(query, *start, *goal, SearchRule::all_neighbours, plan);
    if (reached == Reached::no_path) {
      goal = nearest(wanted, tolerance, [&](const Cell& cell) { return search_.came_to(map_.index(cell.x, cell.y)); });
      if (goal) reached = search(query, *start, *goal, rule(), plan);
    }
  }
  switch (reached) {
    case Reached::goal: return write(query, *start, *goal, plan);
    case Reached::gave_up: return refuse(plan, Outcome::timeout, gave_up);
    case Reached::no_path:
      return goal_blocked ? refuse(plan, Outcome::goal_occupied, goal_cut_off)
                          : refuse(plan, Outcome::no_path, not_connected);
  }
}

void GridPlanner::write(const Query& query, const Place& start, const Place& goal, Plan& plan) {
  refuse(plan, Outcome::found, {});
  plan.start_moved = start.moved * map_.resolution();
  plan.goal_moved = goal.moved * map_.resolution();
  plan.cost = search_.cost() * map_.resolution();
  const auto add = [&](const Vector2& point) {
    if (!plan.points.empty() && plan.points.back() == point) return;
    if (!plan.points.empty()) plan.length += (point - plan.points.back()).norm();
    plan.points.push_back(point);
  };
  add(query.start);
  if (params_.any_angle) {
    for (const Vector2& point : string_.pull(map_, search_.path(), start.point, goal.point))
      // The ends are exactly those of the query, not what becomes of them in cells and back.
      if (point != start.point || start.moved > 0.0)
        if (point != goal.point || goal.moved > 0.0) add(map_.from_cells(point));
  } else {
    for (std::size_t i = start.moved > 0.0 ? 0 : 1; i + 1 < search_.path().size(); ++i)
      add(map_.from_cells(middle_of(search_.path()[i])));
    if (goal.moved > 0.0) add(map_.from_cells(goal.point));
  }
  if (goal.moved == 0.0) add(query.goal);
}

}  // namespace kervan::planning
