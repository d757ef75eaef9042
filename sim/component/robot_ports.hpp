/// The ports of one robot of the component sim/world.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "framework/kervan.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/BumperState.hpp"
#include "kervan_msgs/msg/Contact.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "kervan_msgs/msg/StallState.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "sensor_msgs/msg/Imu.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "sensor_msgs/msg/Range.hpp"
#include "sim/simulation.hpp"
#include "tf2_msgs/msg/TFMessage.hpp"

namespace kervan::sim {

/// Reads a robot's commands and publishes what it measures and does. Its frames are <name>/odom, <name>/base_link and,
/// with a laser, <name>/laser.
class RobotPorts {
 public:
  /// What a robot may have or lack.
  struct Equipment {
    bool laser = false;
    bool gyro = false;
    bool bumpers = false;
    bool stall_flags = false;
  };

  RobotPorts(Component* owner, const std::string& name, const Equipment& equipment);

  /// Hands the drive what has been commanded since the last step; drops it if the robot is not in the world.
  void steer(Simulation& simulation, std::optional<std::size_t> robot);

  /// Another robot begins under this name: what was published of the one before counts no more.
  void restart();

  /// Publishes what is new at `now`, which is `simulated` in the simulation, and adds the robot's frames to `frames` if
  /// its odometry is new: map to odom only if asked for.
  void publish(const Robot& robot, Duration simulated, Time now, tf2_msgs::msg::TFMessage& frames, bool map_to_odom);

  std::uint64_t contacts() const { return contacts_; }  ///< published so far
  bool last_refused() const { return last_refused_; }   ///< the last command was not finite
  const std::string& command_name() const { return cmd_vel_.name(); }

 private:
  void publish_truth(const Robot& robot, Time now);
  void publish_odometry(const OdometryReading& reading, Time now);
  void publish_sonar(const Robot& robot, Time now);
  void publish_scan(const Robot& robot, Time now);
  void publish_contacts(const Robot& robot, Time now);
  void publish_gyro(const GyroReading& reading, double noise, Time now);
  void publish_bumpers(const Robot& robot, Time now);
  void publish_stall(const Stall& stall, Time now);

  std::string odom_frame_;
  std::string base_frame_;
  std::string laser_frame_;
  Input<geometry_msgs::msg::TwistStamped> cmd_vel_;
  Output<kervan_msgs::msg::SonarArray> sonar_;
  std::optional<Output<sensor_msgs::msg::LaserScan>> scan_;
  Output<nav_msgs::msg::Odometry> odom_;
  Output<nav_msgs::msg::Odometry> truth_;
  Output<kervan_msgs::msg::Contact> contact_;
  Output<sensor_msgs::msg::Range> clearance_;
  std::optional<Output<sensor_msgs::msg::Imu>> imu_;
  std::optional<Output<kervan_msgs::msg::BumperState>> bumpers_;
  std::optional<Output<kervan_msgs::msg::StallState>> stall_;
  std::uint64_t contacts_ = 0;
  double min_clearance_ = infinity;
  std::optional<std::vector<bool>> pressed_;  // as published last
  std::optional<Stall> stalled_;
  bool last_refused_ = false;
};

}  // namespace kervan::sim
