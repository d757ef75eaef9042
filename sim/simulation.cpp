#include "sim/simulation.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

namespace kervan::sim {

Simulation::Simulation(std::shared_ptr<const World> world, std::vector<RobotSetup> robots, std::uint64_t seed)
    : world_(std::move(world)) {
  std::set<std::string> names;
  robots_.reserve(robots.size());
  for (RobotSetup& setup : robots) {
    if (!names.insert(setup.name).second) throw std::invalid_argument("two robots have the name " + setup.name);
    // Those before it are placed already.
    robots_.emplace_back(std::move(setup), seed, around(bodies_.size()));
    bodies_.emplace_back(robots_.back().name(), robots_.back().body().outline(), robots_.back().pose());
  }
  order_.resize(robots_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::sort(order_.begin(), order_.end(),
            [this](std::size_t a, std::size_t b) { return robots_[a].name() < robots_[b].name(); });
  for (std::size_t i = 0; i < robots_.size(); ++i) robots_[i].measure_first(around(i));
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
  for (Robot& other : robots_)
    if (other.name() == contact.other) other.touched_by(driving.name(), contact.point);
}

}  // namespace kervan::sim
