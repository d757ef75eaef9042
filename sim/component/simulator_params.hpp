/// The parameters of the component sim/world.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "framework/kervan.hpp"
#include "sim/component/robot_params.hpp"

namespace kervan::sim {

/// The world, the robots in it, and how both are simulated.
struct SimulatorParams {
  FilePath map;
  std::int64_t seed = 1;
  Duration step = std::chrono::milliseconds(10);
  bool map_to_odom = true;
  std::map<std::string, RobotParams> robots;

  template <class Visitor>
  void describe(Visitor& v) {
    v(map, "map", {.help = "World file (worlds/lab.yaml), or a map of ROS (.yaml) or ARIA (.map).", .required = true});
    v(seed, "seed", {.min = 0, .max = 4294967295.0, .help = "Seed of everything random."});
    v(step, "step", {.min = 0.001, .max = 0.1, .help = "Time step of motion and contact."});
    v(map_to_odom, "map_to_odom",
      {.help = "Says on /tf that each odom coincides with map; false when a localisation knows better."});
    v(robots, "robots", {.help = "The robots by their names."});
  }
};

}  // namespace kervan::sim
