#include "components/planning/replan_policy.hpp"

#include <cstdio>
#include <utility>

namespace kervan::planning {
namespace {

/// "0.30 m"
std::string number(double value, int digits, const char* unit) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f %s", digits, value, unit);
  return text;
}

}  // namespace

void ReplanPolicy::begin(Time now) {
  running_ = wanted_ = true;
  blocked_ = false;
  reason_ = "a new goal";
  gave_up_.clear();
  vain_ = 0;
  place_.start({});
  began_ = progressed_at_ = now;
  advanced_ = progressed_ = 0.0;
  not_before_ = ever_planned_ ? last_plan_ + params_.interval : now;
}

void ReplanPolicy::planned(Time now, const std::vector<geometry::Vector2>& route) {
  // The time until there was a route is not the robot's.
  if (place_.empty()) progressed_at_ = now;
  place_.start(route);
  wanted_ = blocked_ = false;
  ever_planned_ = true;
  last_plan_ = now;
  not_before_ = now + params_.interval;
}

void ReplanPolicy::failed(Time now, std::string_view why) {
  if (!route_is_good()) place_.start({});
  ever_planned_ = true;
  last_plan_ = now;
  not_before_ = now + std::max(params_.retry, params_.interval);
  lead_nowhere(std::string(why));
}

void ReplanPolicy::lead_nowhere(std::string why) {
  wanted_ = true;
  reason_ = std::move(why);
  if (++vain_ >= params_.tries) gave_up_ = reason_;
}

void ReplanPolicy::move(Time now, const geometry::Vector2& position) {
  if (!running_ || place_.empty() || !position.allFinite()) return;
  const double before = place_.remaining();
  place_.move(position);
  advanced_ += before - place_.remaining();
  if (advanced_ - progressed_ >= params_.progress) {
    progressed_ = advanced_;
    progressed_at_ = now;
    vain_ = 0;
  }
  if (params_.deviation > 0.0 && place_.off() > params_.deviation && !wanted_)
    ask("the robot is " + number(place_.off(), 2, "m") + " from its route");
  if (params_.progress_within > Duration::zero() && now - progressed_at_ >= params_.progress_within) {
    progressed_at_ = now;
    lead_nowhere("no progress: the robot came less than " + number(params_.progress, 2, "m") + " nearer in " +
                 number(seconds(params_.progress_within), 1, "s"));
  }
}

void ReplanPolicy::blocked() {
  if (!running_ || blocked_ || place_.empty()) return;
  blocked_ = true;
  ask("an obstacle is on the route");
}

void ReplanPolicy::ask(std::string why) {
  if (!running_) return;
  wanted_ = true;
  reason_ = std::move(why);
}

ReplanPolicy::Step ReplanPolicy::step(Time now) {
  if (!running_) return Step::wait;
  if (gave_up_.empty() && params_.time_limit > Duration::zero() && now - began_ >= params_.time_limit)
    gave_up_ = "the goal was not reached within " + number(seconds(params_.time_limit), 1, "s");
  if (!gave_up_.empty()) {
    reason_ = gave_up_;
    return Step::give_up;
  }
  return wanted_ && now >= not_before_ ? Step::plan : Step::wait;
}

}  // namespace kervan::planning
