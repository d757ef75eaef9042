/// The parameters of one robot of the component sim/world.
#pragma once

#include <cstdint>
#include <numbers>
#include <string>

#include "framework/kervan.hpp"
#include "sim/robot.hpp"

namespace kervan::sim {

/// One robot as a composition describes it.
struct RobotParams {
  static constexpr double any_angle = 0.5 * std::numbers::pi;  ///< an incidence limit that limits nothing

  FilePath model;
  Pose2 start;
  double drift = 0.0;
  Duration odometry_period = std::chrono::milliseconds(50);
  Duration sonar_period = std::chrono::milliseconds(100);
  Duration command_timeout = std::chrono::milliseconds(250);
  std::int64_t sonar_rays = 32;
  double sonar_noise = 0.01;
  double sonar_drop_out = 0.0;
  double sonar_incidence_limit = any_angle;
  Duration laser_period = std::chrono::milliseconds(100);
  double laser_noise = 0.005;
  double laser_drop_out = 0.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v(model, "model", {.help = "Robot model file (robots/p3dx.yaml).", .required = true});
    v(start, "start", {.min = -1e6, .max = 1e6, .help = "Pose of base_link in map at the start."});
    v(drift, "drift",
      {.min = 0.0, .max = 0.5, .help = "Bound of the odometry's errors per metre and per radian, drawn once per run."});
    v(odometry_period, "odometry_period", {.min = 0.001, .max = 10.0, .help = "Time between two odometry readings."});
    v(sonar_period, "sonar_period", {.min = 0.001, .max = 10.0, .help = "Time between two rounds of all sonars."});
    v(command_timeout, "command_timeout",
      {.min = 0.01, .max = 10.0, .help = "The drive brakes fully no later than this after the last command."});
    v(sonar_rays, "sonar_rays",
      {.min = 1, .max = 1024, .help = "Rays in the cone of a sonar; 1 is its axis alone, as in Stage."});
    v(sonar_noise, "sonar_noise",
      {.min = 0.0, .max = 1.0, .help = "Standard deviation of a reading as a share of the distance."});
    v(sonar_drop_out, "sonar_drop_out", {.min = 0.0, .max = 1.0, .help = "Probability that an echo is not heard."});
    v(sonar_incidence_limit, "sonar_incidence_limit",
      {.unit = "rad",
       .min = 0.0,
       .max = any_angle,
       .help = "Surfaces met more obliquely give no echo; 90 deg: all do."});
    v(laser_period, "laser_period", {.min = 0.001, .max = 10.0, .help = "Time between two sweeps of the laser."});
    v(laser_noise, "laser_noise",
      {.unit = "m", .min = 0.0, .max = 1.0, .help = "Bound of the uniform error of each range of the laser."});
    v(laser_drop_out, "laser_drop_out",
      {.min = 0.0, .max = 1.0, .help = "Probability that a beam of the laser brings nothing back."});
  }

  /// The robot as the simulation wants it. Reads the model's file; throws ConfigError if it is missing or wrong.
  RobotSetup setup(const std::string& name) const;
};

}  // namespace kervan::sim
