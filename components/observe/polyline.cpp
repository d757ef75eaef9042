#include "components/observe/polyline.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace kervan::observe {
namespace {

double distance_to_segment(const geometry::Vector2& point, const geometry::Vector2& a, const geometry::Vector2& b) {
  const geometry::Vector2 along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (point - a - t * along).norm();
}

}  // namespace

Polyline simplified(const Polyline& line, double tolerance) {
  if (line.size() < 3) return line;
  std::vector<bool> keep(line.size(), false);
  keep.front() = keep.back() = true;
  // A stack of its own: a path that doubles back can split off one point at a time, too deep to recurse.
  std::vector<std::pair<std::size_t, std::size_t>> parts{{0, line.size() - 1}};
  while (!parts.empty()) {
    const auto [first, last] = parts.back();
    parts.pop_back();
    double farthest = tolerance;
    std::size_t split = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double d = distance_to_segment(line[i], line[first], line[last]);
      if (d <= farthest) continue;
      farthest = d;
      split = i;
    }
    if (split == 0) continue;
    keep[split] = true;
    parts.emplace_back(first, split);
    parts.emplace_back(split, last);
  }
  Polyline result;
  for (std::size_t i = 0; i < line.size(); ++i)
    if (keep[i]) result.push_back(line[i]);
  return result;
}

}  // namespace kervan::observe
