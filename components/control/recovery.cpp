#include "components/control/recovery.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace kervan::control {
namespace {

constexpr double pi = std::numbers::pi, right_angle = 0.5 * pi;
constexpr std::array ladder = {Rung::forget,  Rung::replan,     Rung::turn,
                               Rung::back_up, Rung::pull_ahead, Rung::follow_wall};

void lower(double& value, double to) {
  if (!(value <= to)) value = to;
}

}  // namespace

std::string to_text(Rung rung) {
  switch (rung) {
    case Rung::forget: return "forgetting";
    case Rung::replan: return "a new plan";
    case Rung::turn: return "turning";
    case Rung::back_up: return "backing up";
    case Rung::pull_ahead: return "pulling ahead";
    case Rung::follow_wall: return "following the wall";
    case Rung::look_around: return "looking around";
    case Rung::give_up: return "giving up";
  }
  return {};
}

std::string to_text(Trap trap) {
  switch (trap) {
    case Trap::no_way: return "the robot has no way to its goal";
    case Trap::standing: return "the robot stands though it has somewhere to go";
    case Trap::turned_away: return "the robot drives away from its target";
    case Trap::oscillating: return "the robot goes to and fro";
    case Trap::circling: return "the robot does not get out of a small area";
  }
  return {};
}

double Hull::turning_radius() const { return turning > 0.0 ? turning : std::hypot(std::max(front, rear), half_width); }

void RoomFinder::add(const geometry::Pose2& beam, double range, bool hit) {
  if (!std::isfinite(range) || range < 0.0) return;
  constexpr double free = 10.0;   // m, as far as anybody cares
  constexpr double aside = 0.03;  // m, beside the hull
  const auto looked = [](double& value) {
    if (std::isnan(value)) value = free;
  };
  const double cone = 0.5;  // rad, to either side, in which a beam looks ahead or behind
  if (std::abs(beam.yaw) < cone) looked(room_.ahead);
  if (std::abs(beam.yaw) > pi - cone) looked(room_.behind);
  if (std::abs(std::abs(beam.yaw) - 0.5 * pi) < cone) looked(beam.yaw > 0.0 ? room_.left : room_.right);
  looked(room_.around);
  if (!hit) return;
  const geometry::Vector2 end = beam * geometry::Vector2(range, 0.0);
  const double bearing = std::atan2(end.y(), end.x()), distance = end.norm();
  lower(room_.around, distance);
  if (std::abs(std::abs(bearing) - 0.5 * pi) < 0.3 * pi) {
    double& side = bearing > 0.0 ? room_.left : room_.right;
    if (!(side <= distance)) (bearing > 0.0 ? room_.left_bearing : room_.right_bearing) = bearing;
    lower(side, distance);
  }
  const bool beside = std::abs(end.y()) > hull_.half_width;
  if (std::abs(end.y()) > hull_.half_width + aside || (beside && -hull_.rear < end.x() && end.x() < hull_.front))
    return;
  if (end.x() > 0.0) lower(room_.ahead, end.x() - hull_.front);
  if (end.x() < 0.0) lower(room_.behind, -end.x() - hull_.rear);
}

void Recovery::begin() {
  watching_ = gave_up_ = false;
  rung_ = std::nullopt;
  taken_ = 0;
  next_ = 0;
  tried_.clear();
}

void Recovery::watch(Time now, const geometry::Pose2& robot) {
  watching_ = true;
  stood_ = robot;
  area_ = swung_ = robot.position();
  stood_since_ = area_since_ = towards_ = now;
  reversals_ = 0;
}

std::optional<Trap> Recovery::look(Time now, const geometry::Pose2& robot, const geometry::Vector2& target,
                                   const geometry::Twist2& command) {
  const geometry::Vector2 position = robot.position();
  constexpr double turned = 0.5, swing = 0.3, slow = 0.02;
  if ((position - stood_.position()).norm() >= params_.moved ||
      std::abs(geometry::angle_between(stood_.yaw, robot.yaw)) >= turned) {
    stood_ = robot;
    stood_since_ = now;
  }
  if ((position - area_).norm() >= params_.area) {
    area_ = position;
    area_since_ = now;
  }
  if ((position - swung_).norm() >= swing) {
    swung_ = position;
    reversals_ = 0;
  }
  constexpr double noticeable = 0.05;  // m/s, rad/s
  const auto reversed = [](double a, double b) {
    return std::abs(a) > noticeable && std::abs(b) > noticeable && (a < 0.0) != (b < 0.0);
  };
  if (reversed(command.linear, before_.linear) || reversed(command.angular, before_.angular)) ++reversals_;
  before_ = command;
  const geometry::Vector2 way = target - position;
  const double off = geometry::angle_between(robot.yaw, std::atan2(way.y(), way.x()));
  if (std::abs(off) <= right_angle || std::abs(command.linear) < slow) towards_ = now;

  if (now - stood_since_ >= params_.standing) return Trap::standing;
  if (now - towards_ >= params_.turned_away) return Trap::turned_away;
  if (reversals_ >= params_.reversals) return Trap::oscillating;
  if (now - area_since_ >= params_.circling) return Trap::circling;
  return std::nullopt;
}

bool Recovery::helps(Rung rung, Trap trap, const Room& room) const {
  const double far = 2.0 * params_.margin;
  switch (rung) {
    case Rung::turn: return trap == Trap::standing && room.around > params_.hull.turning_radius() + params_.margin;
    case Rung::look_around: return room.around > params_.hull.turning_radius() + params_.margin;
    case Rung::back_up: return room.behind > far;
    case Rung::pull_ahead: return trap == Trap::standing && room.ahead > far;
    case Rung::follow_wall: {
      constexpr double near = 1.0;
      return trap != Trap::standing && (room.left < near || room.right < near || room.ahead < near);
    }
    default: return true;
  }
}

Recovering Recovery::step(Time now, const geometry::Pose2& robot, const std::optional<geometry::Vector2>& target,
                          const geometry::Twist2& command, const Room& room) {
  if (!watching_) watch(now, robot);
  if (gave_up_) return {};
  // With a way or without one there is something else to do.
  if (rung_ && (*rung_ == Rung::look_around) == target.has_value()) {
    rung_ = std::nullopt;
    watch(now, robot);
  }
  const geometry::Vector2 way = target.value_or(robot.position()) - robot.position();
  if (target) {
    const bool another = (*target - target_).norm() > params_.at_target;
    nearest_ = another ? way.norm() : std::min(nearest_, way.norm());
    if (another) nearest_before_ = nearest_when_trapped_ = std::numeric_limits<double>::infinity();
    target_ = *target;
  }
  const double off = geometry::angle_between(robot.yaw, std::atan2(way.y(), way.x()));
  if (rung_) {
    if (auto twist = drive(now, robot, off, room)) return {.twist = twist};
    rung_ = std::nullopt;
    watch(now, robot);
    trial_until_ = now + params_.trial;
  }
  if (!target) return wait_for_a_way(now, robot, room);
  if (way.norm() <= params_.at_target) {
    watch(now, robot);
    return {};
  }
  // One that drives away from its target gets far from where that was noticed, and is no freer for it.
  const bool nearer = nearest_ < nearest_when_trapped_ - params_.moved;
  if (next_ > 0 && nearer && (robot.position() - trapped_).norm() >= params_.free && std::abs(off) <= right_angle) {
    next_ = 0;
    tried_.clear();
  }
  const auto trap = look(now, robot, *target, command);
  if (!trap || now < trial_until_) return {};

  if (next_ == 0) {
    trapped_ = robot.position();
    nearest_when_trapped_ = nearest_;
  }
  while (next_ < ladder.size() && !helps(ladder[next_], *trap, room)) ++next_;
  if (next_ < ladder.size() && taken_ < params_.most_rungs) {
    const Rung rung = ladder[next_++];
    tried_ += (tried_.empty() ? "" : ", ") + to_text(rung);
    return take(rung, *trap, now, robot, room);
  }
  gave_up_ = true;
  Recovering recovering;
  recovering.begun = Rung::give_up;
  recovering.why = to_text(*trap) + (next_ == ladder.size() ? ", and nothing has helped" : ", again and again");
  if (!tried_.empty()) recovering.why += ": " + tried_;
  return recovering;
}

Recovering Recovery::wait_for_a_way(Time now, const geometry::Pose2& robot, const Room& room) {
  // It may have seen only now that there is none, and still be moving.
  if ((robot.position() - stood_.position()).norm() >= params_.moved) watch(now, robot);
  if (now - stood_since_ < params_.standing || now < trial_until_ || taken_ >= params_.most_rungs ||
      !helps(Rung::look_around, Trap::no_way, room))
    return {};
  return take(Rung::look_around, Trap::no_way, now, robot, room);
}

Recovering Recovery::take(Rung rung, Trap trap, Time now, const geometry::Pose2& robot, const Room& room) {
  ++taken_;
  watch(now, robot);
  trial_until_ = now + params_.trial;
  Recovering recovering{.twist = {}, .begun = rung, .why = to_text(trap)};
  if (rung == Rung::forget || rung == Rung::replan) return recovering;
  rung_ = rung;
  began_ = held_up_since_ = now;
  from_ = robot;
  turned_ = 0.0;
  nearest_before_ = nearest_;
  yaw_ = robot.yaw;
  const bool more_at_left = !(room.left < room.right);
  side_ = rung == Rung::follow_wall ? (more_at_left ? -1.0 : 1.0) : (more_at_left ? 1.0 : -1.0);
  recovering.twist = geometry::Twist2{};
  return recovering;
}

/// The manoeuvre's command; nothing when it is over.
std::optional<geometry::Twist2> Recovery::drive(Time now, const geometry::Pose2& robot, double off, const Room& room) {
  constexpr auto patience = std::chrono::seconds(1);
  const Duration since = now - began_;
  geometry::Twist2 wanted;
  turned_ += std::abs(geometry::angle_between(yaw_, robot.yaw));
  yaw_ = robot.yaw;
  if (*rung_ == Rung::look_around) {
    // A drive may turn more slowly than it is told to.
    constexpr double slower = 2.0;
    if (turned_ >= 2.0 * pi || seconds(since) * params_.turn_rate >= slower * 2.0 * pi) return std::nullopt;
    wanted.angular = side_ * params_.turn_rate;
  } else if (*rung_ == Rung::turn) {
    const double turned = std::abs(geometry::angle_between(from_.yaw, robot.yaw));
    constexpr double enough = 0.5, open = 0.5;
    if (since >= params_.manoeuvre || turned >= right_angle || (turned >= enough && room.ahead >= open))
      return std::nullopt;
    wanted.angular = side_ * params_.turn_rate;
  } else if (*rung_ == Rung::back_up || *rung_ == Rung::pull_ahead) {
    if (since >= params_.manoeuvre || (robot.position() - from_.position()).norm() >= params_.back) return std::nullopt;
    wanted.linear = *rung_ == Rung::back_up ? -params_.speed : params_.speed;
  } else {
    constexpr auto least = std::chrono::seconds(3);
    constexpr double open = 0.6;  // m
    const bool nearer = nearest_ < nearest_before_ - params_.moved;
    if (since >= params_.following || (since >= least && nearer && std::abs(off) < right_angle && room.ahead > open))
      return std::nullopt;
    wanted = along_wall(room);
  }
  const geometry::Twist2 twist = safe(wanted, room);
  if (twist.linear != 0.0 || twist.angular != 0.0)
    held_up_since_ = now;
  else if (now - held_up_since_ >= patience)
    return std::nullopt;
  return twist;
}

/// Keeps what is beside the robot beside it, at a distance; turns away from what is before it, and around the end of a
/// wall that it has lost.
geometry::Twist2 Recovery::along_wall(const Room& room) const {
  const double wanted = params_.hull.half_width + 0.3, beside = side_ > 0.0 ? room.left : room.right;
  constexpr double before = 0.35, lost = 1.0;  // m
  constexpr double to_wall = 1.0;              // rad/s per metre
  constexpr double along = 1.2;                // 1/s
  if (room.ahead < before) return {0.0, -side_ * params_.turn_rate};
  if (!(beside < wanted + lost))
    return {params_.speed, std::clamp(side_ * params_.speed / wanted, -params_.turn_rate, params_.turn_rate)};
  const double off = side_ > 0.0 ? room.left_bearing - right_angle : room.right_bearing + right_angle;
  const double turn = side_ * to_wall * (beside - wanted) + along * off;
  return {params_.speed, std::clamp(turn, -params_.turn_rate, params_.turn_rate)};
}

/// As much of a command as there is room for.
geometry::Twist2 Recovery::safe(const geometry::Twist2& wanted, const Room& room) const {
  geometry::Twist2 twist = wanted;
  const bool turns = room.around > params_.hull.turning_radius() + 0.5 * params_.margin;
  if (twist.linear > 0.0 && !(room.ahead > params_.margin)) twist.linear = 0.0;
  if (twist.linear < 0.0 && !(room.behind > params_.margin)) twist.linear = 0.0;
  if (!turns) twist.angular = 0.0;
  return twist;
}

}  // namespace kervan::control
