/// A world with robots in it, and its time. Values in, values out: no clock, no thread, no input or output.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/robot.hpp"
#include "sim/world.hpp"

namespace kervan::sim {

/// The same world, robots, seed, commands and steps give the same results to the last bit, and those of one robot do
/// not depend on where it stands in the list. Within a step the robots drive one after the other, in the order of their
/// names; then all of them measure. They see each other's bodies and cannot drive through each other.
class Simulation {
 public:
  /// The world may be shared with other simulations. Throws std::invalid_argument, naming the robot, if two robots have
  /// one name, two of them stand in each other, or one cannot be as its setup wants it.
  Simulation(std::shared_ptr<const World> world, std::vector<RobotSetup> robots, std::uint64_t seed);

  /// The robot takes this speed from the next step on, and for at most its command_timeout.
  void command(std::size_t robot, const Twist2& wanted) { robots_.at(robot).command(wanted, now_); }

  /// Everything moves on by `dt`, which must be positive. Steps of 10 ms are usual; a robot cannot pass through a wall
  /// however long the step is.
  void step(Duration dt);

  Duration now() const { return now_; }
  const World& world() const { return *world_; }
  const std::vector<Robot>& robots() const { return robots_; }

 private:
  Surroundings around(std::size_t robot) const { return {*world_, bodies_, robot}; }
  void drive(std::size_t robot, Duration dt);

  std::shared_ptr<const World> world_;
  std::vector<Robot> robots_;
  std::vector<PlacedBody> bodies_;  // of the robots, in their order
  std::vector<std::size_t> order_;  // of the robots by their names
  Duration now_{0};
};

}  // namespace kervan::sim
