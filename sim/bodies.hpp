/// The bodies of everything that moves, where they are now, and which of them are near a place. A structure of arrays:
/// a search reads poses and radii alone. Metres, in the frame `map`.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/outline.hpp"

namespace kervan::sim {

class Bodies {
 public:
  /// The new body is the last. Its name is only told, it need not be unique.
  void add(std::string name, const Outline& outline, const Pose2& pose);

  /// Those behind it move up by one.
  void remove(std::size_t body);

  void move(std::size_t body, const Pose2& pose);

  /// The same for many: first it is said how far the centres may move together, then several threads may move
  /// different bodies by no more than that while others search.
  void make_way(double longest) { moved_ += longest; }
  void move_on(std::size_t body, const Pose2& pose);

  std::size_t size() const { return poses_.size(); }
  const std::string& name(std::size_t body) const { return names_[body]; }
  const Outline& outline(std::size_t body) const { return outlines_[body]; }
  const Pose2& pose(std::size_t body) const { return poses_[body]; }
  Vector2 center(std::size_t body) const { return poses_[body].position(); }

  /// A disc of this radius around its centre holds the body; and the largest of them.
  double radius(std::size_t body) const { return radii_[body]; }
  double largest_radius() const { return largest_radius_; }

  /// No more than the distance of two bodies, which it is along the line through their centres; quick. May be negative.
  double separation(std::size_t a, std::size_t b) const;

  std::span<const Vector2> corners(std::size_t body) const {
    return {corners_.data() + first_corner_[body], corner_count(body)};
  }

  /// Sorts all bodies into cells if they have moved too far since the last time: a search finds the same before and
  /// after, but has more to look through then.
  void sort();

  /// All bodies, once they have been sorted, so that neighbours are near each other: going through them in this order
  /// meets the same part of the world again while it is still in the caches.
  std::span<const std::uint32_t> by_place() const { return ids_; }

  /// Calls visit(body) for all bodies whose centres lie in the box, for others too, and perhaps twice; the order says
  /// nothing. Returns true if those were all there are.
  template <class Visit>
  bool visit_box(const Vector2& low, const Vector2& high, Visit&& visit) const;

 private:
  /// The cells of a row or a column that a box reaches; they go on at 0 behind the last.
  struct Cells {
    std::uint32_t first, count;
  };
  Cells cells(double low, double high) const;
  void sort_anew();
  std::uint32_t cell(double coordinate) const;

  template <class Visit>
  void visit_cells(std::uint32_t first, std::uint32_t last, Visit& visit) const {
    for (std::uint32_t i = begin_[first]; i < begin_[last]; ++i) visit(std::size_t{ids_[i]});
  }

  std::size_t corner_count(std::size_t body) const { return first_corner_[body + 1] - first_corner_[body]; }

  std::vector<Pose2> poses_;
  std::vector<double> radii_;
  std::vector<Vector2> corners_;  // in map
  std::vector<std::size_t> first_corner_{0};
  std::vector<Outline> outlines_;
  std::vector<std::string> names_;
  double largest_radius_ = 0.0;

  // A plane of square cells that is rolled up in both directions, so that it has few of them and no edge: side_ of them
  // make a turn. The first `sorted_` bodies are in the cells, and were there when they were sorted.
  std::size_t sorted_ = 0;
  double moved_ = 0.0;  // no coordinate of theirs has changed by more since then
  std::vector<Vector2> sorted_at_;
  std::uint32_t side_ = 0;            // a power of two
  std::vector<std::uint32_t> begin_;  // of each cell in ids_, row by row, and one past the last
  std::vector<std::uint32_t> ids_;
  std::vector<std::uint32_t> cell_of_;
};

inline Bodies::Cells Bodies::cells(double low, double high) const {
  const double first = std::floor(low), count = std::floor(high) - first + 1.0;
  constexpr double countable = 1e15;
  if (!(count < side_) || !(std::abs(first) < countable)) return {0, side_};
  return {cell(low), static_cast<std::uint32_t>(count)};
}

template <class Visit>
bool Bodies::visit_box(const Vector2& low, const Vector2& high, Visit&& visit) const {
  for (std::size_t body = sorted_; body < size(); ++body) visit(body);
  if (sorted_ == 0) return true;
  const Cells columns = cells(low.x() - moved_, high.x() + moved_), rows = cells(low.y() - moved_, high.y() + moved_);
  const std::uint32_t end = columns.first + columns.count;
  for (std::uint32_t i = 0; i < rows.count; ++i) {
    const std::uint32_t row = ((rows.first + i) & (side_ - 1)) * side_;
    visit_cells(row + columns.first, row + std::min(end, side_), visit);
    if (end > side_) visit_cells(row, row + end - side_, visit);
  }
  return columns.count == side_ && rows.count == side_;
}

}  // namespace kervan::sim
