#include "sim/component/robot_ports.hpp"

#include <limits>
#include <numbers>
#include <utility>

#include "framework/geometry/messages.hpp"

namespace kervan::sim {
namespace {

void set_odometry(nav_msgs::msg::Odometry& message, const Pose2& pose, const Twist2& twist) {
  message.pose.pose = geometry::to_message(pose);
  message.twist.twist = geometry::to_message(twist);
}

geometry_msgs::msg::TransformStamped transform(Time stamp, const std::string& parent, const std::string& child,
                                               const Pose2& pose) {
  geometry_msgs::msg::TransformStamped message;
  geometry::set_header(message.header, stamp, parent);
  message.child_frame_id = child;
  message.transform.translation.x = pose.x;
  message.transform.translation.y = pose.y;
  message.transform.rotation = geometry::to_message(pose).orientation;
  return message;
}

}  // namespace

RobotPorts::RobotPorts(Component* owner, const std::string& name, const Equipment& equipment)
    : odom_frame_(name + "/odom"),
      base_frame_(name + "/base_link"),
      laser_frame_(name + "/laser"),
      cmd_vel_(owner, name + "/cmd_vel", qos::command.optional(),
               "Speed wanted of " + name + "; it brakes command_timeout after the last one."),
      sonar_(owner, name + "/sonar", qos::sensor,
             "What the sonars of " + name + " measure; +inf without an echo, NaN if it is not their turn."),
      odom_(owner, name + "/odom", qos::sensor, "Pose and speed of " + name + " by its own wheels."),
      truth_(owner, name + "/truth", qos::state, "True pose in map and true speed of " + name + ", every step."),
      contact_(owner, name + "/contact", qos::event, "Each time " + name + " begins to touch something."),
      clearance_(owner, name + "/clearance", qos::latched,
                 "Least distance of the hull of " + name + " to any obstacle or robot so far.") {
  if (equipment.laser)
    scan_.emplace(owner, name + "/scan", qos::sensor,
                  "What the laser of " + name + ", if it has one, measures in the frame " + laser_frame_ + ".");
  if (equipment.gyro)
    imu_.emplace(owner, name + "/imu", qos::sensor, "Turn rate of " + name + " by its gyroscope, if it has one.");
  if (equipment.bumpers)
    bumpers_.emplace(owner, name + "/bumpers", qos::latched,
                     "Which bumpers of " + name + ", if it wears any, are pressed; when that changes.");
  if (equipment.stall_flags)
    stall_.emplace(owner, name + "/stall", qos::latched,
                   "Which wheels of " + name + " an obstacle holds up, if asked for; when that changes.");
}

void RobotPorts::steer(Simulation& simulation, std::optional<std::size_t> robot) {
  for (const auto& command : cmd_vel_.take()) {
    if (command.disposed() || !robot) continue;
    const auto refused = simulation.robots()[*robot].drive().refused_commands();
    simulation.command(*robot, {command->twist.linear.x, command->twist.angular.z});
    last_refused_ = simulation.robots()[*robot].drive().refused_commands() > refused;
  }
}

void RobotPorts::restart() {
  contacts_ = 0;
  min_clearance_ = infinity;
  pressed_.reset();
  stalled_.reset();
  last_refused_ = false;
}

void RobotPorts::publish(const Robot& robot, Duration simulated, Time now, tf2_msgs::msg::TFMessage& frames,
                         bool map_to_odom) {
  publish_truth(robot, now);
  publish_contacts(robot, now);
  if (robot.odometry().stamp == simulated) {
    publish_odometry(robot.odometry(), now);
    if (map_to_odom) frames.transforms.push_back(transform(now, "map", odom_frame_, Pose2{}));
    frames.transforms.push_back(transform(now, odom_frame_, base_frame_, robot.odometry().pose));
    if (const auto& laser = robot.setup().model.laser)
      frames.transforms.push_back(transform(now, base_frame_, laser_frame_, robot.mounted(laser->pose)));
  }
  if (robot.sonar().stamp == simulated && !robot.sonar().ranges.empty()) publish_sonar(robot, now);
  if (scan_ && robot.laser().stamp == simulated) publish_scan(robot, now);
  if (imu_ && robot.gyro().stamp == simulated) publish_gyro(robot.gyro(), robot.setup().gyro->noise, now);
  if (bumpers_ && pressed_ != robot.pressed()) publish_bumpers(robot, now);
  if (stall_ && stalled_ != robot.stall()) publish_stall(robot.stall(), now);
}

void RobotPorts::publish_truth(const Robot& robot, Time now) {
  auto message = truth_.loan();
  geometry::set_header(message->header, now, "map");
  message->child_frame_id = base_frame_;
  set_odometry(*message, robot.pose(), robot.speed());
  truth_.publish(std::move(message));
}

void RobotPorts::publish_odometry(const OdometryReading& reading, Time now) {
  auto message = odom_.loan();
  geometry::set_header(message->header, now, odom_frame_);
  message->child_frame_id = base_frame_;
  set_odometry(*message, reading.pose, reading.twist);
  odom_.publish(std::move(message));
}

void RobotPorts::publish_sonar(const Robot& robot, Time now) {
  const SonarRing& ring = robot.setup().model.sonars;
  auto message = sonar_.loan();
  geometry::set_header(message->header, now, base_frame_);
  message->field_of_view = static_cast<float>(ring.field_of_view);
  message->min_range = static_cast<float>(ring.min_range);
  message->max_range = static_cast<float>(ring.max_range);
  message->readings.resize(ring.poses.size());
  for (std::size_t i = 0; i < ring.poses.size(); ++i) {
    auto& reading = message->readings[i];
    const Pose2 pose = robot.mounted(ring.poses[i]);
    reading.x = static_cast<float>(pose.x);
    reading.y = static_cast<float>(pose.y);
    reading.yaw = static_cast<float>(pose.yaw);
    reading.range = static_cast<float>(robot.sonar().ranges[i]);
  }
  sonar_.publish(std::move(message));
}

void RobotPorts::publish_scan(const Robot& robot, Time now) {
  const LaserMount& laser = *robot.setup().model.laser;
  auto message = scan_->loan();
  geometry::set_header(message->header, now, laser_frame_);
  message->angle_min = static_cast<float>(-0.5 * laser.field_of_view);
  message->angle_max = static_cast<float>(0.5 * laser.field_of_view);
  message->angle_increment = static_cast<float>(beam_spacing(laser));
  message->scan_time = static_cast<float>(seconds(robot.setup().laser_period));
  message->range_min = static_cast<float>(laser.min_range);
  message->range_max = static_cast<float>(laser.max_range);
  message->ranges.assign(robot.laser().ranges.begin(), robot.laser().ranges.end());
  scan_->publish(std::move(message));
}

void RobotPorts::publish_contacts(const Robot& robot, Time now) {
  const Body& body = robot.body();
  if (body.contacts() > contacts_) {
    contacts_ = body.contacts();
    auto message = contact_.loan();
    geometry::set_header(message->header, now, "map");
    message->robot = robot.name();
    message->other = body.last_contact().other.empty() ? "world" : body.last_contact().other;
    message->point.x = body.last_contact().point.x();
    message->point.y = body.last_contact().point.y();
    message->count = static_cast<std::uint32_t>(contacts_);
    contact_.publish(std::move(message));
  }
  if (body.min_clearance() < min_clearance_) {
    min_clearance_ = body.min_clearance();
    auto message = clearance_.loan();
    geometry::set_header(message->header, now, base_frame_);
    message->field_of_view = static_cast<float>(2.0 * std::numbers::pi);
    message->max_range = std::numeric_limits<float>::infinity();
    message->range = static_cast<float>(min_clearance_);
    clearance_.publish(std::move(message));
  }
}

void RobotPorts::publish_gyro(const GyroReading& reading, double noise, Time now) {
  auto message = imu_->loan();
  geometry::set_header(message->header, now, base_frame_);
  message->angular_velocity.z = reading.rate;
  message->angular_velocity_covariance[8] = noise * noise;
  // Neither orientation nor acceleration is measured.
  message->orientation_covariance[0] = -1.0;
  message->linear_acceleration_covariance[0] = -1.0;
  imu_->publish(std::move(message));
}

void RobotPorts::publish_bumpers(const Robot& robot, Time now) {
  pressed_ = robot.pressed();
  auto message = bumpers_->loan();
  geometry::set_header(message->header, now, base_frame_);
  const std::vector<Pose2>& segments = robot.bumpers().segments();
  message->segments.resize(segments.size());
  message->pressed = false;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Pose2 pose = robot.mounted(segments[i]);
    auto& segment = message->segments[i];
    segment.x = static_cast<float>(pose.x);
    segment.y = static_cast<float>(pose.y);
    segment.yaw = static_cast<float>(pose.yaw);
    segment.length = static_cast<float>(robot.setup().model.bumpers.length);
    segment.pressed = (*pressed_)[i];
    message->pressed = message->pressed || segment.pressed;
  }
  bumpers_->publish(std::move(message));
}

void RobotPorts::publish_stall(const Stall& stall, Time now) {
  stalled_ = stall;
  auto message = stall_->loan();
  geometry::set_header(message->header, now, base_frame_);
  message->left = stall.left;
  message->right = stall.right;
  stall_->publish(std::move(message));
}

}  // namespace kervan::sim
