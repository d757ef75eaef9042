/// The shipped P3-DX, which most tests of the simulator drive.
#pragma once

#include <numbers>

#include "sim/files/robot_file.hpp"
#include "sim/robot.hpp"

namespace kervan::sim {

inline const RobotModel& p3dx() {
  static const RobotModel model = load_robot_model(KERVAN_SIM_FOLDER "/robots/p3dx.yaml");
  return model;
}

/// A P3-DX that measures perfectly.
inline RobotSetup perfect(std::string name, Pose2 start) {
  return {.name = std::move(name), .model = p3dx(), .start = start, .sonar = {.noise = 0.0}};
}

inline constexpr Duration tick = std::chrono::milliseconds(10);
inline constexpr double pi = std::numbers::pi;

}  // namespace kervan::sim
