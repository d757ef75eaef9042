#include "sim/component/robot_params.hpp"

#include "sim/files/robot_file.hpp"

namespace kervan::sim {

RobotSetup RobotParams::setup(const std::string& name) const {
  RobotSetup setup{.name = name, .model = load_robot_model(model.path), .start = start};
  setup.odometry_error = drift;
  setup.odometry_period = odometry_period;
  setup.sonar_period = sonar_period;
  setup.command_timeout = command_timeout;
  setup.sonar = {.rays = static_cast<int>(sonar_rays), .noise = sonar_noise, .drop_out = sonar_drop_out};
  setup.laser_period = laser_period;
  setup.laser = {.noise = laser_noise, .drop_out = laser_drop_out};
  if (sonar_incidence_limit < any_angle) setup.sonar.incidence_limit = sonar_incidence_limit;
  return setup;
}

}  // namespace kervan::sim
