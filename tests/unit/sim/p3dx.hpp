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

/// The robot with all that it may have, and every imperfection. Its sonars fire in turn.
inline RobotSetup with_everything(RobotSetup setup) {
  setup.model = with_bumpers(setup.model, BumperSet::both);
  setup.odometry = {.drift = 0.02, .wheel = 0.01, .slip = 0.001, .resolution = 1e-4};
  setup.gyro = GyroSettings{.bias = 0.01, .scale = 0.01, .noise = 0.01};
  setup.sonar.incidence_limit = 0.5;
  setup.sonar.incidence_drop_off = 0.2;
  setup.sonar.crosstalk = 0.2;
  setup.sonar.firing = SonarFiring::sequential;
  setup.sonar_period = std::chrono::milliseconds(40);
  return setup;
}

inline constexpr Duration tick = std::chrono::milliseconds(10);
inline constexpr double pi = std::numbers::pi;

}  // namespace kervan::sim
