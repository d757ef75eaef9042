#include "sim/contact.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace kervan::sim {

namespace {
constexpr double skin = 1e-6;          // m; nothing comes nearer
constexpr double released = 1e-3;      // m; a touch has ended when everything is farther
constexpr double longest_move = 0.01;  // m; far less than any body is wide, so no obstacle is jumped over
constexpr double doubt = 1e-9;         // m; more than the rounding of sums of distances
}  // namespace

Body::Body(const Outline& outline, const Pose2& start, const Surroundings& around, bool turns)
    : outline_(outline), turns_(turns), yaw_(start.yaw), pose_(start) {
  Hindrances hindrances{around};
  if (!try_pose(start, hindrances))
    throw std::invalid_argument("the body does not fit between the obstacles at its start");
}

double Body::heeds() const { return std::max(min_clearance_, released); }

double Body::length(const Motion& motion) const {
  return std::abs(motion.distance) + outline_.circumradius() * std::abs(motion.turn);
}

Room Body::room_at(const Pose2& pose, const Surroundings& around, bool world) const {
  // Beyond what it heeds any distance does, if only it is more than that at which a touch ends.
  return world ? around.room(outline_, hull(pose))
               : around.exact_room_among_bodies(outline_, hull(pose), heeds() + released);
}

std::optional<Room> Body::free_room_at(const Pose2& pose, Hindrances& hindrances) const {
  auto& [around, world, blocker] = hindrances;
  if (blocker && around.still_in_the_way(*blocker, outline_, hull(pose), skin)) return std::nullopt;
  const Room room = room_at(pose, around, world);
  if (room.all.distance > skin) return room;
  blocker = room;
  return std::nullopt;
}

void Body::note(const Room& room, bool world) {
  if (world) room_ = room.world;
  clear_ = room.all.distance;
  min_clearance_ = std::min(min_clearance_, clear_);
}

bool Body::try_pose(const Pose2& pose, Hindrances& hindrances) {
  const std::optional<Room> room = free_room_at(pose, hindrances);
  if (!room) return false;
  pose_ = pose;
  note(*room, hindrances.world);
  return true;
}

Moved Body::move(const Motion& wanted, const Surroundings& around) {
  const double total = length(wanted);
  if (total == 0.0) return {};

  // What is left of the last look may be less than what a quick one gives.
  if (!(room_ - total > heeds()))
    room_ = std::max(room_, around.world().free_around(pose_.position()) - outline_.circumradius());

  // Far from everything nothing needs to be looked at: neither can the body touch, nor come nearer than it ever was.
  const double room = this->room(around, heeds() + total + doubt);
  if (!touching_ && room - total > min_clearance_) {
    pose_ = advance(pose_, wanted);
    room_ -= total;
    return {wanted};
  }

  const int moves = room - total > skin ? 1 : static_cast<int>(std::ceil(total / longest_move));
  Motion part{wanted.distance / moves, wanted.turn / moves};
  Hindrances hindrances{around, !far_from_world(total)};
  Moved all;
  for (int i = 0; i < moves; ++i) {
    const bool at_rest = part.distance == 0.0 && part.turn == 0.0;
    const Moved now = move_shortly(part, hindrances);
    all.motion.distance += now.motion.distance;
    all.motion.turn += now.motion.turn;
    all.stopped_driving |= now.stopped_driving;
    all.stopped_turning |= now.stopped_turning;
    if (all.stopped_driving) part.distance = 0.0;
    if (all.stopped_turning) part.turn = 0.0;
    if (at_rest) break;  // the other parts would do the same
  }
  if (!hindrances.world) room_ -= total;
  if (clear_ > released) touching_ = false;
  return all;
}

Moved Body::move_shortly(const Motion& wanted, Hindrances& hindrances) {
  if (try_pose(advance(pose_, wanted), hindrances)) return {wanted};

  const double free = drive_up_to_obstacle(wanted, hindrances);
  if (!touching_) begin_contact(hindrances.around);
  const Motion driven{free * wanted.distance, free * wanted.turn};
  const Motion rest{wanted.distance - driven.distance, wanted.turn - driven.turn};
  if (wanted.distance != 0.0 && wanted.turn != 0.0) {
    if (try_pose(advance(pose_, {0.0, rest.turn}), hindrances)) return {{driven.distance, wanted.turn}, true, false};
    if (try_pose(advance(pose_, {rest.distance, 0.0}), hindrances))
      return {{wanted.distance, driven.turn}, false, true};
  }
  return {driven, wanted.distance != 0.0, wanted.turn != 0.0};
}

double Body::drive_up_to_obstacle(const Motion& motion, Hindrances& hindrances) {
  const Pose2 start = pose_;
  const double total = length(motion);
  double free = 0.0, blocked = 1.0;
  // Whoever pushes against something cannot go the least part of the way: then nothing else needs to be tried.
  double least = 1.0;
  while (least * total > skin) least *= 0.5;
  if (!free_room_at(advance(start, {least * motion.distance, least * motion.turn}), hindrances)) return free;
  while ((blocked - free) * total > skin) {
    const double middle = 0.5 * (free + blocked);
    const Pose2 pose = advance(start, {middle * motion.distance, middle * motion.turn});
    (try_pose(pose, hindrances) ? free : blocked) = middle;
  }
  return free;
}

void Body::begin_contact(const Surroundings& around) {
  const Room room = around.room(outline_, hull());
  touching_ = true;
  ++contacts_;
  last_ = {room.all.on_obstacle, pose_, room.other ? *room.other : std::string()};
}

bool Body::put(const Pose2& pose, const Surroundings& around) {
  const double yaw = std::exchange(yaw_, pose.yaw);
  Hindrances hindrances{around};
  if (!try_pose(pose, hindrances)) {
    yaw_ = yaw;
    return false;
  }
  touching_ = false;
  return true;
}

void Body::look(const Surroundings& around) {
  const double among_bodies = around.room_among_bodies(outline_, hull(), heeds());
  // Whether it touches the world its last movement has found out.
  const bool touch_may_end = touching_ && (among_bodies < released || !last_.other.empty());
  if (!touch_may_end && !(among_bodies < min_clearance_)) return;
  const bool world = !far_from_world(0.0);
  note(room_at(pose_, around, world), world);
  if (clear_ > released) touching_ = false;
}

void Body::touched_by(const std::string& other, const Vector2& point) {
  clear_ = 0.0;  // whatever it was when this one looked last
  if (touching_) return;
  touching_ = true;
  ++contacts_;
  last_ = {point, pose_, other};
}

}  // namespace kervan::sim
