/// One simulated robot: its drive, its body and its sensors.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sim/bumpers.hpp"
#include "sim/contact.hpp"
#include "sim/drive.hpp"
#include "sim/gyro.hpp"
#include "sim/laser.hpp"
#include "sim/odometry.hpp"
#include "sim/random.hpp"
#include "sim/robot_model.hpp"
#include "sim/sonar.hpp"
#include "sim/surroundings.hpp"
#include "sim/wheels.hpp"

namespace kervan::sim {

/// A robot as an experiment wants it.
struct RobotSetup {
  std::string name;
  RobotModel model;
  Pose2 start;  ///< of base_link in map
  SonarSettings sonar = {};
  LaserSettings laser = {};
  OdometryErrors odometry = {};
  std::optional<GyroSettings> gyro = {};                   ///< nothing: the robot has none
  double touch_range = 0.02;                               ///< m; see Bumpers
  Duration sonar_period = std::chrono::milliseconds(100);  ///< between two rounds, also of sonars that fire in turn
  Duration laser_period = std::chrono::milliseconds(100);
  Duration odometry_period = std::chrono::milliseconds(50);
  Duration gyro_period = std::chrono::milliseconds(20);
  Duration command_timeout = std::chrono::milliseconds(250);  ///< see Drive
};

/// One round of the sonars; see Sonars::measure for the ranges.
struct SonarScan {
  Duration stamp{0};
  std::vector<double> ranges;
};

/// One sweep of the laser; see Laser::measure for the ranges.
struct LaserSweep {
  Duration stamp{0};
  std::vector<double> ranges;
};

/// What the robot believes of its own motion.
struct OdometryReading {
  Duration stamp{0};
  Pose2 pose;    ///< of base_link in odom
  Twist2 twist;  ///< of base_link
};

/// One reading of the gyroscope.
struct GyroReading {
  Duration stamp{0};
  double rate = 0.0;  ///< rad/s
};

/// A robot cannot stand where it is wanted: something is in the way.
class NoRoom : public std::invalid_argument {
 public:
  NoRoom(std::string robot, std::string other, const std::string& message)
      : std::invalid_argument(message), robot_(std::move(robot)), other_(std::move(other)) {}

  const std::string& robot() const { return robot_; }
  const std::string& other() const { return other_; }  ///< the body that is in the way; empty: the world is

 private:
  std::string robot_;
  std::string other_;
};

class Robot {
 public:
  /// Throws NoRoom if it does not fit at its start, and another std::invalid_argument if the model or a setting cannot
  /// be; both name the robot.
  Robot(RobotSetup setup, std::uint64_t seed, const Surroundings& around);

  void command(const Twist2& wanted, Duration now) { drive_.command(wanted, now); }

  /// What the drive does from `now` to `now + dt` if nothing is in the way.
  const Motion& plan(Duration now, Duration dt);
  const Motion& planned() const { return planned_; }

  /// Drives as planned, as far as the surroundings allow.
  void drive(const Surroundings& around);

  /// When everybody has driven: sees how near the others are, and measures with the sensors that are due after `before`
  /// and not after `now`.
  void measure(const Surroundings& around, Duration before, Duration now);

  /// The same, but the sonars are only made ready to fire with others.
  void measure(const Surroundings& around, Duration before, Duration now, SonarVolley& sonars);

  /// The robot has just been put into the world: measures with all its sensors.
  void measure_first(const Surroundings& around, Duration now);

  /// Stands still at `pose`; see Simulation::teleport.
  void teleport(const Pose2& pose, const Surroundings& around);

  void touched_by(const std::string& other, const Vector2& point) { body_.touched_by(other, point); }

  const RobotSetup& setup() const { return setup_; }
  const std::string& name() const { return setup_.name; }

  /// The truth, which no robot knows: pose of base_link in map, and its speed.
  const Pose2& pose() const { return body_.pose(); }
  const Twist2& speed() const { return drive_.speed(); }
  const Body& body() const { return body_; }
  const Drive& drive() const { return drive_; }

  /// Where something sits in base_link now that is mounted on the body. The body of a synchro drive does not turn with
  /// base_link, so what is mounted on it does not stay where it was.
  Pose2 mounted(const Pose2& on_body) const;

  /// The latest measurements.
  const SonarScan& sonar() const { return sonar_scan_; }
  const LaserSweep& laser() const { return laser_sweep_; }  ///< without ranges if the robot has no laser
  const OdometryReading& odometry() const { return odometry_reading_; }
  const GyroReading& gyro() const { return gyro_reading_; }

  /// What is felt in every step: the bumpers that are pressed, in the order of Bumpers::segments(), and the wheels that
  /// are held up.
  const Bumpers& bumpers() const { return bumpers_; }
  const std::vector<bool>& pressed() const { return pressed_; }
  const Stall& stall() const { return stall_; }

 private:
  void measure_sonar(const Surroundings& around, Duration now, SonarVolley& sonars);
  void measure_laser(const Surroundings& around, Duration now);
  void measure_odometry(Duration now);
  void measure_gyro(Duration now);
  void feel(const Surroundings& around);

  RobotSetup setup_;
  RandomSource random_;
  Drive drive_;
  Motion planned_;
  Duration planned_at_{0};
  Body body_;
  Odometry odometry_;
  Sonars sonars_;
  SonarScan sonar_scan_;
  std::optional<Laser> laser_;
  LaserSweep laser_sweep_;
  OdometryReading odometry_reading_;
  std::optional<Gyro> gyro_;
  GyroReading gyro_reading_;
  Bumpers bumpers_;
  std::vector<bool> pressed_;
  Stall stall_;
};

}  // namespace kervan::sim
