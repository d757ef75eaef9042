#include "components/planning/string_pulling.hpp"

#include <cmath>
#include <limits>

#include "components/planning/line_walk.hpp"

namespace kervan::planning {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double rounding = 1e-9;  // of a cost
constexpr int halvings = 6;        // of how far a corner may move
constexpr int rounds = 4;
constexpr double worth_it = 1e-3;  // of a cell, that a round has to gain for another

geometry::Vector2 middle_of(const GridSearch::Cell& cell) { return {cell.x + 0.5, cell.y + 0.5}; }

/// The cost, or infinity as soon as it is more than `most`.
double cost_up_to(const Costmap& map, const geometry::Vector2& a, const geometry::Vector2& b, double most) {
  const double length = (b - a).norm();
  double cost = 0.0;
  const bool free = walk_line(a, b, [&](int x, int y, double share) {
    const std::uint8_t weight = map.weight(map.index(x, y));
    cost += share * weight;
    return weight >= Costmap::lightest;
  });
  cost *= length / Costmap::lightest;
  return free && cost <= most ? cost : infinity;
}

}  // namespace

double line_cost(const Costmap& map, const geometry::Vector2& a, const geometry::Vector2& b) {
  return cost_up_to(map, a, b, infinity);
}

const std::vector<geometry::Vector2>& StringPuller::pull(const Costmap& map, const std::vector<GridSearch::Cell>& path,
                                                         const geometry::Vector2& start,
                                                         const geometry::Vector2& goal) {
  points_.clear();
  costs_.clear();
  points_.push_back(start);
  for (std::size_t i = 1; i + 1 < path.size(); ++i) points_.push_back(middle_of(path[i]));
  points_.push_back(goal);
  costs_.push_back(0.0);
  for (std::size_t i = 1; i < points_.size(); ++i)
    costs_.push_back(costs_.back() + line_cost(map, points_[i - 1], points_[i]));
  keep_corners(map);
  for (int round = 0; round < rounds && tighten(map); ++round) {
  }
  return pulled_;
}

bool StringPuller::may_replace(const Costmap& map, std::size_t from, std::size_t to) const {
  const double way = costs_[to] - costs_[from];
  return cost_up_to(map, points_[from], points_[to], way * (1.0 + rounding) + rounding) < infinity;
}

/// From each corner to the farthest point that a line may lead to: in steps that double while they are good, then by
/// halves. Farther ones may be good, too, behind some that are not; a string would not find them either.
void StringPuller::keep_corners(const Costmap& map) {
  pulled_.assign(1, points_.front());
  std::size_t at = 0;
  const std::size_t last = points_.size() - 1;
  while (at < last) {
    std::size_t good = at + 1, bad = last + 1;
    for (std::size_t step = 2; good < last && bad > last; step *= 2) {
      const std::size_t next = std::min(good + step, last);
      if (may_replace(map, at, next))
        good = next;
      else
        bad = next;
    }
    while (bad <= last && bad - good > 1) {
      const std::size_t between = good + (bad - good) / 2;
      (may_replace(map, at, between) ? good : bad) = between;
    }
    at = good;
    pulled_.push_back(points_[at]);
  }
}

/// Where on the line to `before` the corner may go for the way on to `after`.
geometry::Vector2 StringPuller::cut(const Costmap& map, const geometry::Vector2& before,
                                    const geometry::Vector2& corner, const geometry::Vector2& after) const {
  const geometry::Vector2 line = before - corner;
  const double there = line_cost(map, before, corner), on = line_cost(map, corner, after);
  double good = 0.0, bad = 1.0;
  double cheapest = there + on;
  for (int i = 0; i < halvings; ++i) {
    const double share = i == 0 ? 1.0 : 0.5 * (good + bad);
    const geometry::Vector2 to = corner + share * line;
    const double cost = line_cost(map, before, to) + line_cost(map, to, after);
    if (cost < cheapest) {
      cheapest = cost;
      good = share;
      if (i == 0) break;
    } else {
      bad = share;
    }
  }
  return corner + good * line;
}

bool StringPuller::tighten(const Costmap& map) {
  double gained = 0.0;
  for (std::size_t i = 1; i + 1 < pulled_.size();) {
    const geometry::Vector2 before = pulled_[i - 1], after = pulled_[i + 1];
    geometry::Vector2& corner = pulled_[i];
    const double was = (corner - before).norm() + (after - corner).norm();
    corner = cut(map, before, corner, after);
    if (corner != before) corner = cut(map, after, corner, before);
    gained += was - (corner - before).norm() - (after - corner).norm();
    if (corner == before || corner == after)
      pulled_.erase(pulled_.begin() + static_cast<std::ptrdiff_t>(i));
    else
      ++i;
  }
  return gained > worth_it;
}

}  // namespace kervan::planning
