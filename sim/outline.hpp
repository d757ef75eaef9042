/// The body of a robot seen from above: a convex polygon in its own frame (base_link).
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "sim/shapes.hpp"

namespace kervan::sim {

/// How near an outline and an obstacle are. Both points are in the frame in which the obstacle was given; they coincide
/// when the distance is 0.
struct Clearance {
  double distance = infinity;  ///< m; 0 when they touch or overlap
  Vector2 on_obstacle = Vector2::Zero();
  Vector2 on_outline = Vector2::Zero();
};

class Outline {
 public:
  /// Corners counter-clockwise, m, at least three, strictly convex, around the frame's origin.
  /// Throws std::invalid_argument that says which of these fails.
  explicit Outline(std::vector<Vector2> corners);

  std::span<const Vector2> corners() const { return corners_; }

  /// Distance from the origin to the farthest corner: a disc of this radius holds the body however it turns.
  double circumradius() const { return circumradius_; }

  /// Distance from the origin to the nearest edge: the body holds a disc of this radius.
  double inradius() const { return inradius_; }

  /// True if the point lies in the body or on its edge.
  bool contains(const Vector2& point) const;

  /// No more than the clearance to the segment, and quick: how far it lies beyond one of the edges. May be negative.
  double separation(const Segment& segment) const {
    double most = -infinity;
    for (std::size_t i = 0; i < corners_.size(); ++i)
      most = std::max(most, std::min(height(i, segment.a), height(i, segment.b)));
    return most;
  }

  /// Exact clearance to a shape given in the outline's own frame.
  Clearance clearance(const Segment& segment) const;
  Clearance clearance(const Circle& circle) const;

 private:
  /// m; how far the point lies beyond edge i.
  double height(std::size_t i, const Vector2& point) const { return outward_[i].dot(point - corners_[i]); }
  Segment edge(std::size_t i) const { return {corners_[i], corners_[i + 1 == corners_.size() ? 0 : i + 1]}; }

  std::vector<Vector2> corners_;
  std::vector<Vector2> outward_;  // of edge i, unit length
  double circumradius_ = 0.0;
  double inradius_ = infinity;
};

}  // namespace kervan::sim
