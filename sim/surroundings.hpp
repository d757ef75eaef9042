/// What a robot meets: the world, which never moves, and the bodies of all that moves, where they are now. Metres, in
/// the frame `map`.
#pragma once

#include <limits>
#include <span>
#include <string>

#include "sim/bodies.hpp"
#include "sim/groups.hpp"
#include "sim/world.hpp"

namespace kervan::sim {

/// How much room a body has, and what takes it.
struct Room {
  Clearance all;                       ///< to the nearest of everything
  double world = infinity;             ///< m to the world alone
  ShapeRef shape = {};                 ///< of the world that is nearest
  const std::string* other = nullptr;  ///< the name of the body that is nearest; nullptr: the world is
  std::size_t body = 0;                ///< the index of that body
};

class Surroundings {
 public:
  /// `bodies` may hold the body of the robot that asks, at the place `self`; it is left out. World and bodies must
  /// outlive the surroundings.
  Surroundings(const World& world, const Bodies& bodies, std::size_t self)
      : Surroundings(world, bodies, self, self + 1) {}
  /// The bodies from `first` on are left out, up to the one before `last`.
  Surroundings(const World& world, const Bodies& bodies, std::size_t first, std::size_t last)
      : world_(&world), bodies_(first > 0 || last < bodies.size() ? &bodies : nullptr), first_(first), last_(last) {}
  /// Of the bodies only those of the group of `self` are there.
  Surroundings(const World& world, const Bodies& bodies, std::size_t self, const Groups& groups)
      : Surroundings(world, bodies, self) {
    groups_ = &groups;
  }
  /// A world in which nothing moves.
  Surroundings(const World& world) : world_(&world) {}  // NOLINT(google-explicit-constructor): it is nothing more

  const World& world() const { return *world_; }

  /// How much room the body has at `pose`. Exact; of bodies that are equally near the first by name.
  Room room(const Outline& outline, const Pose2& pose) const;

  /// The same among the other bodies alone, as far as `within`: farther away nobody is looked for, and the distance is
  /// `within`.
  Room exact_room_among_bodies(const Outline& outline, const Pose2& pose, double within) const;

  /// True if what took the room at another pose leaves no more than `within` at this one. Bodies have not moved since.
  bool still_in_the_way(const Room& room, const Outline& outline, const Pose2& pose, double within) const;

  /// No more than the distance of the body to any other; quick, and may be negative. If nobody is within `within` it is
  /// any number from there on.
  double room_among_bodies(const Outline& outline, const Pose2& pose, double within) const;

  /// What rays meet, as World::cast: the nearest of the world and the bodies. `range` is finite. Exact as to the
  /// bodies.
  void cast(std::span<const RayFan> fans, double range, std::span<RayHit> hits,
            Normals normals = Normals::wanted) const;

  /// The bodies' part of that: `hits` is what the rays meet of the world, and becomes what they meet at all.
  void cast_among_bodies(std::span<const RayFan> fans, double range, std::span<RayHit> hits, Normals normals) const;

 private:
  void take_room(const Outline& outline, const Pose2& pose, Room& room) const;
  bool left_out(std::size_t body) const {
    return (body >= first_ && body < last_) || (groups_ && groups_->apart(first_, body));
  }

  const World* world_;
  const Bodies* bodies_ = nullptr;  // nullptr: there are no others
  std::size_t first_ = 0, last_ = 0;
  const Groups* groups_ = nullptr;  // nullptr: the bodies of all groups are there
};

/// How near a body at `pose` and one of `bodies` are; 0 when they touch or overlap. Points in map, `on_obstacle` on the
/// latter. Exact up to `within`; farther away it is any distance from there on.
Clearance clearance(const Bodies& bodies, std::size_t other, const Outline& outline, const Pose2& pose,
                    double within = infinity);

}  // namespace kervan::sim
