#include "components/exploration/target_tour.hpp"

#include <numbers>

namespace kervan::exploration {

void TargetTour::give_up() {
  if (!target_ || back_off_.active()) return;
  ++figures_.unreachable;
  target_.reset();
}

TargetTour::Event TargetTour::next_target(Time now, const geometry::Vector2& position) {
  const std::optional<Area> area = params_.area ? params_.area : area_around(obstacles_);
  if (area) target_ = draw_target(params_.seed, figures_.targets, *area, obstacles_, params_.room);
  if (!area || !target_) return Event::no_target;
  ++figures_.targets;
  given_ = now;
  if (!first_given_) first_given_ = now;
  visits_.begin(position);
  detector_.reset();
  return Event::new_target;
}

TargetTour::Event TargetTour::step(Time now, const geometry::Pose2& pose, bool commanded) {
  const geometry::Vector2 position = pose.position();
  if (last_) figures_.path += (position - *last_).norm();
  last_ = position;
  if (back_off_.active()) {
    manoeuvre_ = back_off_.step(now, pose);
    if (manoeuvre_) return Event::none;
    target_.reset();
  }
  if (!target_) return next_target(now, position);

  while (visits_.look(position)) ++figures_.points;
  if ((*target_ - position).norm() <= params_.arrive_within) {
    ++figures_.reached;
    if (!figures_.first_reached) figures_.first_reached = now - *first_given_;
    return next_target(now, position);
  }
  if (detector_.look(now, position, commanded)) {
    const std::uint64_t turn = ~figures_.stuck++;  // no target has such a number
    const double angle = params_.least_turn + (std::numbers::pi - params_.least_turn) * uniform(params_.seed, turn, 0);
    back_off_.start(now, pose, uniform(params_.seed, turn, 1) < 0.5 ? -angle : angle);
    manoeuvre_ = back_off_.step(now, pose);
    return Event::stuck;
  }
  if (now - given_ >= params_.patience) {
    ++figures_.late;
    return next_target(now, position);
  }
  return Event::none;
}

}  // namespace kervan::exploration
