#include "components/observe/mission_score.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::observe {

MissionScore::MissionScore(MissionParams params, const MissionMemory& memory)
    : params_(std::move(params)), start_(memory.start) {
  figures_.goal = std::min(memory.goal, params_.goals.size() - 1);
  figures_.path = memory.path;
  figures_.contacts = memory.contacts;
  figures_.min_clearance = memory.min_clearance;
}

MissionMemory MissionScore::memory() const {
  return {start_, figures_.goal, figures_.path, figures_.contacts, figures_.min_clearance};
}

void MissionScore::truth(Time now, const geometry::Pose2& pose, const geometry::Twist2& twist) {
  if (ended()) return;
  const geometry::Vector2 position = pose.position();
  figures_.error = (goal() - position).norm();
  figures_.time = seconds(now - start_);
  if (last_position_) figures_.path += (position - *last_position_).norm();
  if (!approached_ || figures_.error < figures_.closest) {
    approached_ = true;
    figures_.closest = figures_.error;
    figures_.closest_at = position;
  }
  last_position_ = position;

  const bool stands = !params_.standing ||
                      (std::abs(twist.linear) <= params_.rest_speed && std::abs(twist.angular) <= params_.rest_turn);
  if (!stands || !(figures_.error <= params_.tolerance)) {
    at_rest_since_.reset();
  } else if (!at_rest_since_) {
    at_rest_since_ = now;
  }
  if (at_rest_since_ && (!params_.standing || now - *at_rest_since_ >= params_.rest_time)) {
    if (figures_.goal + 1 == params_.goals.size()) {
      figures_.outcome = MissionOutcome::reached;
      figures_.time = seconds(*at_rest_since_ - start_);
      return;
    }
    ++figures_.goal;
    at_rest_since_.reset();
    approached_ = false;
  }
  tick(now);
}

void MissionScore::contact(std::uint32_t count) {
  if (!ended()) figures_.contacts = std::max(figures_.contacts, count);
}

void MissionScore::clearance(double distance) {
  if (ended() || std::isnan(distance)) return;
  figures_.min_clearance = std::min(distance, figures_.min_clearance.value_or(distance));
}

void MissionScore::give_up(Time now) {
  if (ended()) return;
  figures_.outcome = MissionOutcome::given_up;
  figures_.time = seconds(now - start_);
}

void MissionScore::tick(Time now) {
  if (!ended() && params_.contact_ends && figures_.contacts > 0) {
    figures_.outcome = MissionOutcome::touched;
    figures_.time = seconds(now - start_);
  }
  if (ended() || now - start_ < params_.timeout) return;
  figures_.outcome = MissionOutcome::timed_out;
  figures_.time = seconds(now - start_);
}

}  // namespace kervan::observe
