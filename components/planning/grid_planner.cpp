#include "components/planning/grid_planner.hpp"

#include <algorithm>
#include <cmath>

#include "components/planning/plan_ends.hpp"

namespace kervan::planning {
namespace {

using geometry::Vector2;

constexpr std::string_view gave_up = "no route: the search was given up, it looked at as many cells as it may";

}  // namespace

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
  const auto ends = find_ends(map_, query, plan);
  if (!ends) return;
  const Place& start = ends->start;
  std::optional<Place> goal = ends->goal;
  Reached reached = search(query, start, *goal, rule(), plan);
  if (reached == Reached::no_path && query.tolerance > 0.0) {
    // What can be reached at all is what a search that looks at all neighbours came to.
    if (rule() != SearchRule::all_neighbours) reached = search(query, start, *goal, SearchRule::all_neighbours, plan);
    if (reached == Reached::no_path) {
      goal = nearest_free(map_, map_.to_cells(query.goal), query.tolerance / map_.resolution(),
                          [&](const Cell& cell) { return search_.came_to(map_.index(cell.x, cell.y)); });
      if (goal) reached = search(query, start, *goal, rule(), plan);
    }
  }
  switch (reached) {
    case Reached::goal: return write(query, start, *goal, plan);
    case Reached::gave_up: return refuse(plan, Outcome::timeout, gave_up);
    case Reached::no_path:
      return ends->goal_blocked ? refuse(plan, Outcome::goal_occupied, goal_cut_off)
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
