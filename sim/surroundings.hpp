/// What a robot meets: the world, which never moves, and the bodies of the other robots where they are now. Metres, in
/// the frame `map`.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/world.hpp"

namespace kervan::sim {

/// The body of a robot at a place in the map.
class PlacedBody {
 public:
  PlacedBody(std::string name, Outline outline, const Pose2& pose);

  void move_to(const Pose2& pose);

  const std::string& name() const { return name_; }
  const Outline& outline() const { return outline_; }
  const Pose2& pose() const { return pose_; }
  std::span<const Vector2> corners() const { return corners_; }  ///< in map
  Segment edge(std::size_t i) const { return {corners_[i], corners_[i + 1 == corners_.size() ? 0 : i + 1]}; }

 private:
  std::string name_;
  Outline outline_;
  Pose2 pose_;
  std::vector<Vector2> corners_;
};

/// How much room a body has, and what takes it.
struct Room {
  Clearance all;                      ///< to the nearest of everything
  double world = infinity;            ///< m to the world alone
  const PlacedBody* other = nullptr;  ///< the robot that is nearest; nullptr: the world is
};

class Surroundings {
 public:
  /// `bodies` may hold the body of the robot that asks, at the place `self`; it is left out. Both arguments must
  /// outlive the surroundings.
  Surroundings(const World& world, std::span<const PlacedBody> bodies, std::size_t self)
      : world_(world), bodies_(bodies), self_(self) {}
  /// A world without other robots.
  Surroundings(const World& world) : world_(world) {}  // NOLINT(google-explicit-constructor): it is nothing more

  const World& world() const { return world_; }

  /// How much room the body has at `pose`. Exact.
  Room room(const Outline& outline, const Pose2& pose) const;

  /// No more than the distance of the body to any other robot; quick, and may be negative. Infinity without others.
  double room_among_robots(const Outline& outline, const Pose2& pose) const;

  /// The other robots that anything within `range` of `point` may meet.
  std::vector<const PlacedBody*> robots_within(const Vector2& point, double range) const;

 private:
  const World& world_;
  std::span<const PlacedBody> bodies_;
  std::size_t self_ = 0;
};

/// The first of the bodies along the ray, no farther than `range`; nothing if there is none. Exact.
std::optional<RayHit> cast(std::span<const PlacedBody* const> bodies, const Ray& ray, double range);

/// How near two bodies are; 0 when they touch or overlap. Points in map, `on_obstacle` on `other`. Exact.
Clearance clearance(const PlacedBody& other, const Outline& outline, const Pose2& pose);

}  // namespace kervan::sim
