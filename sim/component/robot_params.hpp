/// The parameters of one robot of the component sim/world.
#pragma once

#include <cstdint>
#include <numbers>
#include <string>

#include "framework/kervan.hpp"
#include "sim/robot.hpp"

namespace kervan::sim {

/// Where the errors of a robot's dead reckoning come from.
enum class OdometrySource { given, model };

/// One robot as a composition describes it.
struct RobotParams {
  static constexpr double any_angle = 0.5 * std::numbers::pi;  ///< an incidence limit that limits nothing

  FilePath model;
  Pose2 start;
  bool present = true;
  OdometrySource odometry_errors = OdometrySource::given;
  double drift = 0.0;
  double wheel_error = 0.0;
  double wheel_slip = 0.0;
  double encoder_resolution = 0.0;
  Duration odometry_period = std::chrono::milliseconds(50);
  bool gyro = false;
  Duration gyro_period = std::chrono::milliseconds(20);
  double gyro_bias = 0.0;
  double gyro_scale = 0.0;
  double gyro_noise = 0.0;
  SonarFiring sonar_firing = SonarFiring::all;
  Duration sonar_period = std::chrono::milliseconds(100);
  Duration sonar_slot = std::chrono::milliseconds(40);
  Duration command_timeout = std::chrono::milliseconds(250);
  std::int64_t sonar_rays = 32;
  double sonar_noise = 0.01;
  double sonar_drop_out = 0.0;
  double sonar_incidence_limit = any_angle;
  double sonar_incidence_drop_off = 0.0;
  double sonar_crosstalk = 0.0;
  Duration laser_period = std::chrono::milliseconds(100);
  double laser_noise = 0.005;
  double laser_noise_share = 0.0;
  double laser_range = 0.0;
  double laser_drop_out = 0.0;
  BumperSet bumpers = BumperSet::none;
  double touch_range = 0.02;
  bool stall_flags = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v(model, "model", {.help = "Robot model file (robots/p3dx.yaml).", .required = true});
    v(start, "start", {.min = -1e6, .max = 1e6, .help = "Pose of base_link in map at the start."});
    v(present, "present", {.help = "Is in the world at the start; otherwise it has ports, and a request spawns it."});
    v(odometry_errors, "odometry_errors",
      {.choices = {"given", "model"},
       .help = "The errors that are given here, or those that the model's file holds as typical."});
    v(drift, "drift",
      {.min = 0.0, .max = 0.5, .help = "Bound of the odometry's errors per metre and per radian, drawn once per run."});
    v(wheel_error, "wheel_error",
      {.min = 0.0, .max = 0.5, .help = "Bound of the scale error of each wheel, drawn once per run."});
    v(wheel_slip, "wheel_slip",
      {.unit = "m",
       .min = 0.0,
       .max = 1.0,
       .help = "Standard deviation of what slipping does to the way of each wheel within its first metre."});
    v(encoder_resolution, "encoder_resolution",
      {.unit = "m", .min = 0.0, .max = 0.1, .help = "Way of a wheel for one tick of its encoder; 0: no ticks."});
    v(odometry_period, "odometry_period", {.min = 0.001, .max = 10.0, .help = "Time between two odometry readings."});
    v(gyro, "gyro", {.help = "Whether the robot has a gyroscope about its vertical axis."});
    v(gyro_period, "gyro_period", {.min = 0.001, .max = 10.0, .help = "Time between two readings of the gyroscope."});
    v(gyro_bias, "gyro_bias",
      {.unit = "rad/s", .min = 0.0, .max = 1.0, .help = "Bound of its constant error, drawn once per run."});
    v(gyro_scale, "gyro_scale", {.min = 0.0, .max = 0.5, .help = "Bound of its scale error, drawn once per run."});
    v(gyro_noise, "gyro_noise",
      {.unit = "rad/s", .min = 0.0, .max = 1.0, .help = "Standard deviation of the error of each of its readings."});
    v(sonar_firing, "sonar_firing",
      {.choices = {"all", "sequential"},
       .help = "All sonars in every round, or in every slot the next one of each array of the model."});
    v(sonar_period, "sonar_period", {.min = 0.001, .max = 10.0, .help = "Time between two rounds of all sonars."});
    v(sonar_slot, "sonar_slot", {.min = 0.001, .max = 1.0, .help = "Time between two slots of sequential firing."});
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
    v(sonar_incidence_drop_off, "sonar_incidence_drop_off",
      {.unit = "rad",
       .min = 0.0,
       .max = any_angle,
       .help = "Over this angle below the limit the probability of an echo falls from 1 to 0."});
    v(sonar_crosstalk, "sonar_crosstalk",
      {.min = 0.0, .max = 1.0, .help = "Probability that a sonar hears another one that fires together with it."});
    v(laser_period, "laser_period", {.min = 0.001, .max = 10.0, .help = "Time between two sweeps of the laser."});
    v(laser_noise, "laser_noise",
      {.unit = "m", .min = 0.0, .max = 1.0, .help = "Bound of the uniform error of each range of the laser."});
    v(laser_noise_share, "laser_noise_share",
      {.min = 0.0, .max = 1.0, .help = "Standard deviation of another error of them, as a share of the distance."});
    v(laser_range, "laser_range",
      {.unit = "m", .min = 0.0, .max = 1000.0, .help = "How far the laser measures; 0: as the model's file says."});
    v(laser_drop_out, "laser_drop_out",
      {.min = 0.0, .max = 1.0, .help = "Probability that a beam of the laser brings nothing back."});
    v(bumpers, "bumpers",
      {.choices = {"none", "front", "rear", "both"}, .help = "Which of the model's bumpers the robot wears."});
    v(touch_range, "touch_range",
      {.unit = "m", .min = 0.0001, .max = 0.1, .help = "A bumper is pressed by what is as near as this."});
    v(stall_flags, "stall_flags", {.help = "Whether the robot says which of its wheels an obstacle holds up."});
  }

  /// The robot as the simulation wants it. Reads the model's file; throws ConfigError if it is missing or wrong, and
  /// ParameterError if parameters do not fit it or each other.
  RobotSetup setup(const std::string& name) const;
};

}  // namespace kervan::sim
