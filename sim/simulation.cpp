#include "sim/simulation.hpp"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <string>
#include <utility>

namespace kervan::sim {

Simulation::Simulation(std::shared_ptr<const World> world, std::vector<RobotSetup> robots, std::uint64_t seed)
    : world_(std::move(world)), seed_(seed) {
  robots_.reserve(robots.size());
  for (RobotSetup& setup : robots) add(std::move(setup));
  for (std::size_t i = 0; i < robots_.size(); ++i) robots_[i].measure_first(around(i), now_);
}

/// Those that are there already are in its way.
void Simulation::add(RobotSetup setup) {
  const auto place =
      std::lower_bound(order_.begin(), order_.end(), setup.name,
                       [this](std::size_t robot, const std::string& name) { return robots_[robot].name() < name; });
  if (place != order_.end() && robots_[*place].name() == setup.name)
    throw std::invalid_argument("two robots have the name " + setup.name);
  Robot robot(std::move(setup), seed_, around(bodies_.size()));
  bodies_.emplace_back(robot.name(), robot.body().outline(), robot.pose());
  order_.insert(place, robots_.size());
  robots_.push_back(std::move(robot));
}

void Simulation::spawn(RobotSetup robot) {
  add(std::move(robot));
  robots_.back().measure_first(around(robots_.size() - 1), now_);
}

void Simulation::remove(std::string_view name) {
  const std::size_t robot = place_of(name);
  robots_.erase(robots_.begin() + static_cast<std::ptrdiff_t>(robot));
  bodies_.erase(bodies_.begin() + static_cast<std::ptrdiff_t>(robot));
  std::erase(order_, robot);
  for (std::size_t& place : order_)
    if (place > robot) --place;
}

void Simulation::teleport(std::string_view name, const Pose2& pose) {
  const std::size_t robot = place_of(name);
  robots_[robot].teleport(pose, around(robot));
  bodies_[robot].move_to(pose);
}

std::optional<std::size_t> Simulation::find(std::string_view name) const {
  const auto place =
      std::lower_bound(order_.begin(), order_.end(), name,
                       [this](std::size_t robot, std::string_view wanted) { return robots_[robot].name() < wanted; });
  if (place == order_.end() || robots_[*place].name() != name) return std::nullopt;
  return *place;
}

std::size_t Simulation::place_of(std::string_view name) const {
  if (const auto found = find(name)) return *found;
  throw std::invalid_argument("there is no robot " + std::string(name));
}

void Simulation::step(Duration dt) {
  assert(dt > Duration::zero());
  for (const std::size_t i : order_) drive(i, dt);
  for (std::size_t i = 0; i < robots_.size(); ++i) robots_[i].measure(around(i), now_, now_ + dt);
  now_ += dt;
}

void Simulation::drive(std::size_t robot, Duration dt) {
  Robot& driving = robots_[robot];
  const std::uint64_t contacts = driving.body().contacts();
  driving.drive(around(robot), now_, dt);
  bodies_[robot].move_to(driving.pose());
  if (driving.body().contacts() == contacts) return;
  const Contact& contact = driving.body().last_contact();
  if (contact.other.empty()) return;
  robots_[place_of(contact.other)].touched_by(driving.name(), contact.point);
}

}  // namespace kervan::sim
