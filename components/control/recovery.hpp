/// Notices that a robot is trapped and tries, for a bounded time and a bounded number of times, to get it free.
#pragma once

#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::control {

/// What is free around a robot, in base_link, m. NaN: nothing looks there.
struct Room {
  double ahead = std::numeric_limits<double>::quiet_NaN();   ///< before the hull, in its width
  double behind = std::numeric_limits<double>::quiet_NaN();  ///< behind the hull, in its width
  double left = std::numeric_limits<double>::quiet_NaN();    ///< from base_link to what is nearest beside it
  double right = std::numeric_limits<double>::quiet_NaN();
  double left_bearing = 0.5 * std::numbers::pi;  ///< rad, of what is nearest at the left: in -pi .. pi
  double right_bearing = -0.5 * std::numbers::pi;
  double around = std::numeric_limits<double>::quiet_NaN();  ///< from base_link to what is nearest in any direction
};

/// The hull as a rectangle around base_link, m.
struct Hull {
  double front = 0.25;
  double rear = 0.30;
  double half_width = 0.22;
  double turning = 0.0;  ///< radius of the circle that it sweeps when it turns on the spot; 0: that of its corners

  double turning_radius() const;
};

/// Collects what beams measure into a Room.
class RoomFinder {
 public:
  explicit RoomFinder(const Hull& hull) : hull_(hull) {}

  /// A beam in base_link, and where it hit something, m along it. One that hit nothing still looks where it points. A
  /// range that is not finite or negative says nothing.
  void add(const geometry::Pose2& beam, double range, bool hit);

  Room room() const { return room_; }

 private:
  Hull hull_;
  Room room_;
};

/// In the order in which they are tried; looking around is for a robot that has no way at all.
enum class Rung { forget, replan, turn, back_up, pull_ahead, follow_wall, look_around, give_up };

enum class Trap {
  no_way,       ///< there is no way to its goal, as far as is known
  standing,     ///< it has somewhere to go and does not move
  turned_away,  ///< it drives, but for long away from its target
  oscillating,  ///< its commands change their sign again and again, on the spot
  circling,     ///< it moves, but not out of a small area
};

struct RecoveryParams {
  Hull hull;
  double at_target = 0.35;                          ///< m; nearer to its target than this a robot may stand
  Duration standing = std::chrono::seconds(4);      ///< without moving `moved` or turning half a radian
  double moved = 0.10;                              ///< m
  Duration turned_away = std::chrono::seconds(12);  ///< with the target more than 90 degrees off the heading
  std::int64_t reversals = 12;                      ///< of commands, within 0.3 m
  double area = 1.0;                                ///< m, radius
  Duration circling = std::chrono::seconds(30);     ///< within the area
  double free = 1.5;                                ///< m, from where it was trapped: there it counts as free
  double speed = 0.15;                              ///< m/s, of manoeuvres
  double turn_rate = 0.6;                           ///< rad/s, of manoeuvres
  double back = 0.4;                                ///< m, that it backs up or pulls ahead at most
  double margin = 0.08;                             ///< m, to what a manoeuvre may come near
  Duration manoeuvre = std::chrono::seconds(6);     ///< a turn or backing up takes at most
  Duration following = std::chrono::seconds(90);    ///< a wall is followed at most
  Duration trial = std::chrono::seconds(3);         ///< the controller's, after each rung
  std::int64_t most_rungs = 24;                     ///< for one goal
};

/// What the robot is to do now.
struct Recovering {
  std::optional<geometry::Twist2> twist = {};  ///< instead of the controller's command
  std::optional<Rung> begun = {};  ///< a rung was taken now; `forget`, `replan`, `give_up` are for others to do
  std::string why = {};            ///< of `begun`, one sentence
};

/// A ladder of rungs. Each time the robot is found trapped it takes the next that can help: a turn where there is room
/// to turn, backing up where it is seen to be free, a wall where there is one. Once the robot is `free` metres away,
/// and nearer to its target than ever before or on its way to another, it begins anew, but one goal gets at most
/// `most_rungs` of them all: so a robot reaches its goal or gives it up. After that it stays out of the way until the
/// next goal. A robot without a way looks around from time to time, since a door may have opened behind it; whoever
/// looks for ways gives up. A wall is left where the robot is nearer to its target than ever before, as in Lumelsky and
/// Stepanov, Path-planning strategies for a point mobile automaton moving amidst unknown obstacles of arbitrary shape
/// (Algorithmica 2, 1987), so that it does not come back into the trap. No manoeuvre drives or turns into what is seen,
/// or where nothing is seen.
class Recovery {
 public:
  explicit Recovery(const RecoveryParams& params) : params_(params) {}

  void set_params(const RecoveryParams& params) { params_ = params; }

  /// Another goal: everything counts anew.
  void begin();

  /// Pose and target are finite and of one frame; no target: there is no way to the goal. `command` is the
  /// controller's. Times must not go back.
  Recovering step(Time now, const geometry::Pose2& robot, const std::optional<geometry::Vector2>& target,
                  const geometry::Twist2& command, const Room& room);

  /// There is nowhere to go, or nobody knows where the robot is: nothing that was seen counts.
  void rest() {
    watching_ = false;
    rung_ = std::nullopt;
  }

  /// The manoeuvre that goes on; none while the controller drives.
  std::optional<Rung> manoeuvre() const { return rung_; }

 private:
  std::optional<Trap> look(Time now, const geometry::Pose2& robot, const geometry::Vector2& target,
                           const geometry::Twist2& command);
  Recovering wait_for_a_way(Time now, const geometry::Pose2& robot, const Room& room);
  Recovering take(Rung rung, Trap trap, Time now, const geometry::Pose2& robot, const Room& room);
  void watch(Time now, const geometry::Pose2& robot);
  bool helps(Rung rung, Trap trap, const Room& room) const;
  std::optional<geometry::Twist2> drive(Time now, const geometry::Pose2& robot, double off, const Room& room);
  geometry::Twist2 along_wall(const Room& room) const;
  geometry::Twist2 safe(const geometry::Twist2& wanted, const Room& room) const;

  RecoveryParams params_;
  bool watching_ = false;
  bool gave_up_ = false;
  // What is being watched.
  geometry::Pose2 stood_;
  Time stood_since_{};
  geometry::Vector2 area_ = geometry::Vector2::Zero();
  Time area_since_{};
  geometry::Vector2 swung_ = geometry::Vector2::Zero();
  std::int64_t reversals_ = 0;
  geometry::Twist2 before_;
  Time towards_{};  // when it drove towards its target last
  geometry::Vector2 target_ = geometry::Vector2::Zero();
  double nearest_ = 0.0;  // m, that it came to this target
  // The ladder.
  std::int64_t taken_ = 0;
  std::size_t next_ = 0;
  geometry::Vector2 trapped_ = geometry::Vector2::Zero();
  double nearest_when_trapped_ = 0.0;  // m
  std::string tried_;
  Time trial_until_{};
  // The manoeuvre.
  std::optional<Rung> rung_;
  Time began_{};
  geometry::Pose2 from_;
  double side_ = 1.0;            // 1: to the left
  double turned_ = 0.0;          // rad, all of it
  double yaw_ = 0.0;             // when turned_ was counted last
  double nearest_before_ = 0.0;  // m, that it came to its target before it began
  Time held_up_since_{};
};

std::string to_text(Rung rung);
std::string to_text(Trap trap);

}  // namespace kervan::control
