#include "components/behavior/stall_recover.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kervan::behavior {
namespace {

enum class Turn { none, away, left, right };

struct Attempt {
  double drive;  // 1 forward, -1 backward
  Turn turn;
  std::string_view why;
};

constexpr std::array<Attempt, 10> sequence{{
    {-1.0, Turn::away, "stalled: back and turn away"},
    {1.0, Turn::away, "stalled: forward and turn away"},
    {-1.0, Turn::none, "stalled: back"},
    {1.0, Turn::none, "stalled: forward"},
    {0.0, Turn::left, "stalled: turn left"},
    {0.0, Turn::right, "stalled: turn right"},
    {-1.0, Turn::left, "stalled: back and turn left"},
    {-1.0, Turn::right, "stalled: back and turn right"},
    {1.0, Turn::left, "stalled: forward and turn left"},
    {1.0, Turn::right, "stalled: forward and turn right"},
}};

/// 1: to the left, -1: to the right.
double away(const Situation& situation) {
  if (situation.stall.left != situation.stall.right) return situation.stall.left ? -1.0 : 1.0;
  const SonarView view = situation.view();
  const double left = std::min(view.left_front(), view.left_rear());
  return left < view.beside() ? -1.0 : 1.0;
}

}  // namespace

void StallRecover::begin(const Situation& situation) {
  const bool soon = ended_ && situation.now - *ended_ <= params_.again_within;
  attempt_ = soon ? (attempt_ + 1) % sequence.size() : 0;
  const Turn turn = sequence[attempt_].turn;
  side_ = turn == Turn::left ? 1.0 : turn == Turn::right ? -1.0 : away(situation);
  moving_ = true;
  turned_enough_ = turn == Turn::none;
  began_ = situation.now;
  turned_.start(situation.pose.yaw);
}

Wish StallRecover::step(const Situation& situation) {
  if (moving_ && situation.now - began_ >= params_.move_time) {
    moving_ = false;
    ended_ = situation.now;
  }
  if (!moving_) {
    if (!situation.stall.any()) return no_wish("no wheel is stalled");
    begin(situation);
  }
  const Attempt& attempt = sequence[attempt_];
  turned_enough_ = turned_enough_ || std::abs(turned_.add(situation.pose.yaw)) >= params_.turn;

  const SonarView view = situation.view();
  const bool second_half = situation.now - began_ >= params_.move_time / 2;
  const double room = attempt.drive < 0.0 ? view.rear() : view.front();
  const bool drives = attempt.drive != 0.0 && !(second_half && room < params_.obstacle_distance);
  const double rate = params_.turn / seconds(params_.move_time) * 2.0;  // done by the middle of the attempt
  return {true, {drives ? attempt.drive * params_.speed : 0.0, turned_enough_ ? 0.0 : side_ * rate}, attempt.why};
}

}  // namespace kervan::behavior
