#include "sim/component/robot_params.hpp"

#include <stdexcept>
#include <utility>

#include "sim/files/robot_file.hpp"

namespace kervan::sim {

RobotSetup RobotParams::setup(const std::string& name) const {
  const auto refuse = [&name](const char* parameter, const std::string& why) {
    throw ParameterError("robots." + name + "." + parameter, why);
  };
  RobotModel loaded = load_robot_model(model.path);
  try {
    loaded = with_bumpers(std::move(loaded), bumpers);
  } catch (const std::invalid_argument& error) {
    refuse("bumpers", error.what());
  }
  RobotSetup setup{.name = name, .model = std::move(loaded), .start = start};
  setup.odometry = {.drift = drift, .wheel = wheel_error, .slip = wheel_slip, .resolution = encoder_resolution};
  if (odometry_errors == OdometrySource::model) {
    if (drift > 0.0 || wheel_error > 0.0 || wheel_slip > 0.0 || encoder_resolution > 0.0)
      refuse("odometry_errors",
             "the errors are those of the model; leave out drift, wheel_error, wheel_slip and "
             "encoder_resolution, or set this to given");
    setup.odometry = setup.model.odometry;
  }
  setup.odometry_period = odometry_period;
  if (gyro) setup.gyro = GyroSettings{.bias = gyro_bias, .scale = gyro_scale, .noise = gyro_noise};
  setup.gyro_period = gyro_period;
  setup.command_timeout = command_timeout;
  setup.sonar = {.rays = static_cast<int>(sonar_rays), .noise = sonar_noise, .drop_out = sonar_drop_out};
  setup.sonar.firing = sonar_firing;
  setup.sonar_period = sonar_firing == SonarFiring::all ? sonar_period : sonar_slot;
  if (sonar_incidence_drop_off > sonar_incidence_limit)
    refuse("sonar_incidence_drop_off", "is more than sonar_incidence_limit");
  setup.sonar.incidence_drop_off = sonar_incidence_drop_off;
  if (sonar_incidence_limit < any_angle || sonar_incidence_drop_off > 0.0)
    setup.sonar.incidence_limit = sonar_incidence_limit;
  setup.sonar.crosstalk = sonar_crosstalk;
  setup.laser_period = laser_period;
  setup.laser = {.noise = laser_noise, .noise_share = laser_noise_share, .drop_out = laser_drop_out};
  if (setup.model.laser && laser_range > 0.0) {
    if (laser_range <= setup.model.laser->min_range) refuse("laser_range", "is no more than the nearest it measures");
    setup.model.laser->max_range = laser_range;
  }
  setup.touch_range = touch_range;
  return setup;
}

}  // namespace kervan::sim
