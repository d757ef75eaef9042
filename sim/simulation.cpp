#include "sim/simulation.hpp"

#include <cassert>
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
    robots_.emplace_back(std::move(setup), seed, *world_);
  }
}

void Simulation::step(Duration dt) {
  assert(dt > Duration::zero());
  for (Robot& robot : robots_) robot.step(*world_, now_, dt);
  now_ += dt;
}

}  // namespace kervan::sim
