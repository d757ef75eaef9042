#include "components/control/dwa.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kervan::control {
namespace {

using geometry::Pose2;
using geometry::Twist2;
using geometry::Vector2;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float step_time = 0.1f;  // s
/// A robot that is nearer to something than its margin already may come nearer by this in a motion, or it could not
/// even drive along it.
constexpr float slack = 0.002f;  // m
/// With less than this share of its margin it may only move to where it has more: by many motions, each with its slack
/// and seen with noise, it would touch in the end.
constexpr float least_share = 0.4f;
/// A target nearer than this has no direction.
constexpr float no_direction = 0.05f;  // m

/// How far ahead of the end of a motion, and at how many places, it is looked whether the way to the target is free.
constexpr float sight = 0.9f;  // m
constexpr int sights = 3;

/// Turning rates lie closer together near zero, where they are for keeping a course.
constexpr int turns = 9;   // to each side
constexpr int speeds = 6;  // forward

float square(float x) { return x * x; }

/// `from` on its way to `to` for `time`: slowing down at one rate, speeding up at another.
float ramped(float from, float to, float up, float down, float time) {
  if (from * to < 0.0f) to = 0.0f;  // a change of direction passes through zero
  const float most = (std::abs(to) > std::abs(from) ? up : down) * time;
  return from + std::clamp(to - from, -most, most);
}

}  // namespace

DynamicWindow::DynamicWindow(const DwaParams& params) : params_(params) {}

void DynamicWindow::set_params(const DwaParams& params) { params_ = params; }

void DynamicWindow::drive(State& state, float v, float w, float time) const {
  const auto up = static_cast<float>(params_.acceleration), down = static_cast<float>(params_.deceleration);
  const auto turn = static_cast<float>(params_.turn_acceleration);
  const float v_end = ramped(state.v, v, up, down, time), w_end = ramped(state.w, w, turn, turn, time);
  const float way = 0.5f * (state.v + v_end) * time, angle = 0.5f * (state.w + w_end) * time;
  const float middle = state.yaw + 0.5f * angle;
  state.x += way * std::cos(middle);
  state.y += way * std::sin(middle);
  state.yaw += angle;
  state.v = v_end;
  state.w = w_end;
}

/// Until a command takes effect, the last one is driven.
DynamicWindow::State DynamicWindow::predicted(const Twist2& speed) const {
  State state{.v = static_cast<float>(speed.linear), .w = static_cast<float>(speed.angular)};
  drive(state, static_cast<float>(last_.linear), static_cast<float>(last_.angular), static_cast<float>(params_.delay));
  return state;
}

void DynamicWindow::gather(const Pose2& at, std::span<const SeenPoints::Point> points) {
  const Pose2 to_robot = at.inverse();
  const float c = static_cast<float>(std::cos(to_robot.yaw)), s = static_cast<float>(std::sin(to_robot.yaw));
  spots_.resize(points.size());
  bin_of_.resize(points.size());
  bins_.fill(0);
  constexpr auto nowhere = static_cast<std::uint32_t>(side * side);
  const auto place = [&](const Vector2& point) {
    const Vector2 off = point - at.position();
    const auto x = static_cast<float>(off.x()), y = static_cast<float>(off.y());
    return Spot{c * x - s * y, s * x + c * y};
  };
  // A counting sort: how many there are in each bin, where each bin begins, and then each to its bin.
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Spot spot = place(points[i].at);
    const float column = spot.x / bin_size + side / 2, row = spot.y / bin_size + side / 2;
    const bool near = column >= 0.0f && column < side && row >= 0.0f && row < side;
    bin_of_[i] = near ? static_cast<std::uint32_t>(static_cast<int>(row) * side + static_cast<int>(column)) : nowhere;
    if (near) ++bins_[bin_of_[i] + 1];
  }
  for (std::size_t bin = 1; bin < bins_.size(); ++bin) bins_[bin] += bins_[bin - 1];
  for (std::size_t i = points.size(); i-- > 0;)
    if (bin_of_[i] != nowhere) spots_[--bins_[bin_of_[i] + 1]] = place(points[i].at);
  // Each bin's end has become its beginning, one place too far up.
  std::copy(bins_.begin() + 1, bins_.end(), bins_.begin());
  bins_.back() = static_cast<std::uint32_t>(
      std::count_if(bin_of_.begin(), bin_of_.end(), [](std::uint32_t bin) { return bin != nowhere; }));
}

float DynamicWindow::clearance(const State& state) const {
  const auto front = static_cast<float>(params_.hull.front), rear = static_cast<float>(params_.hull.rear);
  const auto half_width = static_cast<float>(params_.hull.half_width), comfort = static_cast<float>(params_.comfort);
  const float middle = 0.5f * (front - rear), half_length = 0.5f * (front + rear);
  const float c = std::cos(state.yaw), s = std::sin(state.yaw);
  const float x = state.x + c * middle, y = state.y + s * middle;
  const float along = std::abs(c) * half_length + std::abs(s) * half_width + comfort,
              across = std::abs(s) * half_length + std::abs(c) * half_width + comfort;
  const auto bin = [](float at) { return std::clamp(static_cast<int>(at / bin_size + side / 2), 0, side - 1); };
  const int left = bin(x - along), right = bin(x + along), low = bin(y - across), high = bin(y + across);
  float nearest = square(comfort), deepest = 0.0f;
  for (int row = low; row <= high; ++row) {
    const Spot* const end = spots_.data() + bins_[static_cast<std::size_t>(row * side + right) + 1];
    for (const Spot* spot = spots_.data() + bins_[static_cast<std::size_t>(row * side + left)]; spot != end; ++spot) {
      const float dx = spot->x - x, dy = spot->y - y;
      const float ahead = std::abs(c * dx + s * dy) - half_length, aside = std::abs(c * dy - s * dx) - half_width;
      nearest = std::min(nearest, square(std::max(ahead, 0.0f)) + square(std::max(aside, 0.0f)));
      deepest = std::min(deepest, std::max(ahead, aside));
    }
  }
  return deepest < 0.0f ? deepest : std::sqrt(nearest);
}

/// Whether the robot would have room on the next piece of the straight way to the target.
bool DynamicWindow::sees_target(const State& state, float dx, float dy, float distance) const {
  const float yaw = std::atan2(dy, dx);
  for (int i = 1; i <= sights; ++i) {
    const float way = sight * static_cast<float>(i) / static_cast<float>(sights);
    if (way > distance) return true;
    if (clearance({state.x + way / distance * dx, state.y + way / distance * dy, yaw, 0.0f, 0.0f}) < allowed_)
      return false;
  }
  return true;
}

/// To turn to the target and drive there.
float DynamicWindow::time_left(const State& state) const {
  const float dx = target_.x - state.x, dy = target_.y - state.y;
  const float distance = std::sqrt(square(dx) + square(dy));
  float error = 0.0f;
  if (distance > no_direction)
    error = std::abs(static_cast<float>(geometry::wrap_angle(static_cast<double>(std::atan2(dy, dx) - state.yaw))));
  const float detour = sees_target(state, dx, dy, distance) ? 0.0f : static_cast<float>(params_.detour_cost);
  return distance / static_cast<float>(params_.v_max) + static_cast<float>(params_.turn_cost) * error + detour;
}

float DynamicWindow::cost(float v, float w) const {
  const auto margin = static_cast<float>(params_.margin), comfort = static_cast<float>(params_.comfort);
  const auto v_max = static_cast<float>(params_.v_max), near_speed = static_cast<float>(params_.near_speed);
  const auto period = static_cast<float>(params_.period), horizon = static_cast<float>(params_.horizon);
  const float distance = std::sqrt(square(target_.x) + square(target_.y));

  State state = begin_, soon = begin_;
  drive(soon, v, w, period);
  const float to_stop = std::abs(soon.v) * period + square(soon.v) / (2.0f * static_cast<float>(params_.deceleration));
  const float to_face =
      std::abs(soon.w) * period + square(soon.w) / (2.0f * static_cast<float>(params_.turn_acceleration));

  const bool moves = v != 0.0f || w != 0.0f;
  float way = 0.0f, turned = 0.0f, time = 0.0f, dearer = 0.0f, room = 0.0f, result = infinity;
  while (time < horizon - 0.5f * step_time) {
    const State before = state;
    drive(state, v, w, step_time);
    room = clearance(state);
    if (room < allowed_) {
      if ((moves && wanted_ > 0.0f) || way < to_stop || turned < to_face) return infinity;
      // It would have to stand there for the rest of the time.
      if (result == infinity) result = horizon + dearer + time_left(before);
      break;
    }
    const float piece = 0.5f * std::abs(before.v + state.v) * step_time;
    way += piece;
    turned += std::abs(state.yaw - before.yaw);
    time += step_time;
    const float nearness = std::clamp((comfort - room) / std::max(comfort - margin, 1e-3f), 0.0f, 1.0f);
    const float no_haste = v_max + nearness * (std::min(near_speed, v_max) - v_max);
    const float haste = std::max(0.0f, std::abs(state.v) / std::max(no_haste, 1e-3f) - 1.0f);
    dearer += piece * (static_cast<float>(params_.near_cost) * square(nearness) +
                       static_cast<float>(params_.haste_cost) * haste);
    // The target is passed, or has been missed; what comes after is looked at only for room to brake.
    if (way >= distance && result == infinity) result = time + dearer + time_left(state);
    if (result < infinity && way >= to_stop && turned >= to_face) break;
  }
  if (moves && room < wanted_) return infinity;
  if (result == infinity) result = time + dearer + time_left(state);
  const float change = std::abs(v - static_cast<float>(last_.linear)) / v_max +
                       std::abs(w - static_cast<float>(last_.angular)) / static_cast<float>(params_.turn_rate);
  return result + static_cast<float>(params_.change_cost) * change;
}

DwaStep DynamicWindow::step(const RobotState& robot, const Vector2& target, std::span<const SeenPoints::Point> points) {
  DwaStep step;
  if (const auto why = fault_of(robot, target); !why.empty()) {
    reset();
    step.outcome = Outcome::fault;
    step.why = why;
    return step;
  }
  const State ahead = predicted(robot.twist);
  const Pose2 begin =
      robot.pose * Pose2{static_cast<double>(ahead.x), static_cast<double>(ahead.y), static_cast<double>(ahead.yaw)};
  begin_ = {.v = ahead.v, .w = ahead.w};
  gather(begin, points);
  const Vector2 to_target = begin.inverse() * target;
  target_ = {static_cast<float>(to_target.x()), static_cast<float>(to_target.y())};
  const float room = clearance(begin_);
  const float least = least_share * static_cast<float>(params_.margin);
  wanted_ = room < least ? least : 0.0f;
  allowed_ = room < least ? room : std::max(least, std::min(static_cast<float>(params_.margin), room - slack));
  step.clearance = static_cast<double>(room);

  const auto v_max = static_cast<float>(params_.v_max), v_back = static_cast<float>(params_.v_back);
  const auto w_max = static_cast<float>(params_.turn_rate), window = static_cast<float>(params_.window);
  const float v_low = std::max(-v_back, begin_.v - static_cast<float>(params_.deceleration) * window),
              v_high = std::min(v_max, begin_.v + static_cast<float>(params_.acceleration) * window);
  const float w_reach = static_cast<float>(params_.turn_acceleration) * window;
  float best = infinity;
  const auto consider = [&](float v, float w) {
    const float price = cost(v, w);
    if (!(price < best)) return;
    best = price;
    step.twist = {static_cast<double>(v), static_cast<double>(w)};
  };
  const auto with_all_turns = [&](float v) {
    for (int k = -turns; k <= turns; ++k) {
      const float share = static_cast<float>(k) / static_cast<float>(turns);
      const float w = w_max * share * std::abs(share);
      if (std::abs(w - begin_.w) <= w_reach) consider(v, w);
    }
  };
  for (int k = -2; k <= speeds; ++k) {
    const float v =
        k < 0 ? v_back * static_cast<float>(k) / 2.0f : v_max * static_cast<float>(k) / static_cast<float>(speeds);
    if ((k < 0 && v_back == 0.0f) || v < v_low || v > v_high) continue;
    with_all_turns(v);
  }
  step.cost = static_cast<double>(best);
  if (best == infinity) {
    step.outcome = Outcome::hindered;
    step.why = "no motion leaves room to brake";
  }
  last_ = step.twist;
  return step;
}

}  // namespace kervan::control
