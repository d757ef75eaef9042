/// A solid body among solid obstacles and other bodies.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "sim/drive.hpp"
#include "sim/surroundings.hpp"

namespace kervan::sim {

/// One touch, from the moment the body is stopped by an obstacle until it is free again.
struct Contact {
  Vector2 point = Vector2::Zero();  ///< in map, on the obstacle
  Pose2 pose;                       ///< of the body in map when the touch began
  std::string other;                ///< the name of the body that is touched; empty: the world
};

/// What became of a movement.
struct Moved {
  Motion motion;                 ///< what was really done
  bool stopped_driving = false;  ///< an obstacle cut the distance short
  bool stopped_turning = false;  ///< an obstacle cut the turn short
};

/// Moves a body so that it never enters an obstacle or another body. It is always more than a micrometre from all of
/// them, so it can neither stick to a wall nor be pushed through one, however thin the wall and however long the step.
/// Bodies do not push each other: one that drives into another is stopped as by a wall.
class Body {
 public:
  /// Throws std::invalid_argument if there is no room for the body at `start`. A body that does not turn, as that of a
  /// synchro drive, keeps its orientation while its pose, which is that of base_link, turns.
  Body(const Outline& outline, const Pose2& start, const Surroundings& around, bool turns = true);

  /// Moves along the arc as far as the obstacles allow. On contact the translation stops and the body only turns on; if
  /// an obstacle stops the turning but not the translation, as it does when the tail touches a wall, it drives straight
  /// on.
  Moved move(const Motion& wanted, const Surroundings& around);

  /// Lifts the body and puts it down at `pose`, as it stood at the start, touching nothing. False, and nothing changes,
  /// if there is no room.
  bool put(const Pose2& pose, const Surroundings& around);

  /// Others may have come nearer or gone away since the last movement.
  void look(const Surroundings& around);

  /// Another body has driven into this one, at `point`.
  void touched_by(const std::string& other, const Vector2& point);

  const Pose2& pose() const { return pose_; }
  const Outline& outline() const { return outline_; }

  /// Where the outline lies in map, and all that is mounted on the body with it.
  Pose2 hull() const { return hull(pose_); }

  /// No more than the clearance to everything is now; quick, and may be negative. Beyond `within` it is any number from
  /// there on.
  double room(const Surroundings& around, double within) const {
    return std::min(room_, around.room_among_bodies(outline_, hull(), within));
  }

  /// True from the moment an obstacle stops a movement, or another body is stopped by this one, until the body is a
  /// millimetre away from all of them.
  bool touching() const { return touching_; }
  std::uint64_t contacts() const { return contacts_; }   ///< touches begun so far
  const Contact& last_contact() const { return last_; }  ///< meaningful once contacts() > 0

  /// The smallest clearance to the world and to other bodies so far, m.
  double min_clearance() const { return min_clearance_; }

  /// As long as other bodies stay farther than this, it makes no difference to this one whether they are there.
  double heeds() const;

  /// No point of the body moves farther than this.
  double length(const Motion& motion) const;

 private:
  Pose2 hull(const Pose2& pose) const { return turns_ ? pose : Pose2{pose.x, pose.y, yaw_}; }
  /// What matters during one movement.
  struct Hindrances {
    const Surroundings& around;
    bool world = true;                           // false: it is too far away to make a difference
    std::optional<Room> blocker = std::nullopt;  // what was in the way last: it is likely to be so again
  };
  /// True if the world makes no difference to a body that moves by this length.
  bool far_from_world(double length) const { return room_ - length > heeds(); }
  /// Exact as far as it matters.
  Room room_at(const Pose2& pose, const Surroundings& around, bool world) const;
  /// The same at a pose that is free.
  std::optional<Room> free_room_at(const Pose2& pose, Hindrances& hindrances) const;
  void note(const Room& room, bool world);
  /// Takes the pose if it is free.
  bool try_pose(const Pose2& pose, Hindrances& hindrances);
  /// The part of a blocked arc, in [0, 1), that is free; takes the pose there.
  double drive_up_to_obstacle(const Motion& motion, Hindrances& hindrances);
  /// One movement that is short enough not to jump over anything.
  Moved move_shortly(const Motion& wanted, Hindrances& hindrances);
  void begin_contact(const Surroundings& around);

  Outline outline_;
  bool turns_;
  double yaw_;  // of the outline when it was put down
  Pose2 pose_;
  double room_ = 0.0;   // no more than the clearance to the world is now; exact after a look at it
  double clear_ = 0.0;  // to everything, when it was last looked at
  double min_clearance_ = infinity;
  bool touching_ = false;
  std::uint64_t contacts_ = 0;
  Contact last_;
};

}  // namespace kervan::sim
