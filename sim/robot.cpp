#include "sim/robot.hpp"

#include <cmath>
#include <utility>

namespace kervan::sim {

namespace {

void require_finite(const std::string& robot, const Pose2& pose) {
  if (!pose.position().allFinite() || !std::isfinite(pose.yaw))
    throw std::invalid_argument("robot " + robot + ": its pose must be finite");
}

RobotSetup valid(RobotSetup setup) {
  if (setup.name.empty()) throw std::invalid_argument("a robot needs a name");
  require_valid(setup.model);
  require_finite(setup.name, setup.start);
  if (setup.sonar_period <= Duration::zero() || setup.laser_period <= Duration::zero() ||
      setup.odometry_period <= Duration::zero())
    throw std::invalid_argument("robot " + setup.name + ": the periods of its sensors must be positive");
  if (setup.command_timeout <= Duration::zero())
    throw std::invalid_argument("robot " + setup.name + ": the time-out of its drive must be positive");
  if (!(setup.odometry_error >= 0.0 && setup.odometry_error < 1.0))
    throw std::invalid_argument("robot " + setup.name + ": the odometry error must be in [0, 1)");
  return setup;
}

/// What to throw when `robot` "would stand" at `pose`, or "starts" there.
NoRoom no_room(const std::string& robot, const char* stands, const Outline& outline, const Pose2& pose,
               const Surroundings& around) {
  const Room room = around.room(outline, pose);
  const std::string other = room.other ? *room.other : std::string();
  return {robot, other, "robot " + robot + " " + stands + " in or against " + (other.empty() ? "an obstacle" : other)};
}

Body placed(const RobotSetup& setup, const Surroundings& around) {
  try {
    return Body(setup.model.outline, setup.start, around);
  } catch (const std::invalid_argument&) {
    throw no_room(setup.name, "starts", setup.model.outline, setup.start, around);
  }
}

/// True if a multiple of `period` lies in (before, now].
bool due(Duration period, Duration before, Duration now) { return now / period > before / period; }

}  // namespace

Robot::Robot(RobotSetup setup, std::uint64_t seed, const Surroundings& around)
    : setup_(valid(std::move(setup))),
      random_(seed, setup_.name),
      drive_(setup_.model.drive, setup_.command_timeout),
      body_(placed(setup_, around)),
      odometry_(setup_.start, setup_.odometry_error, random_),
      sonars_(setup_.model.sonars, setup_.sonar) {
  sonar_scan_.ranges.resize(sonars_.size());
  if (setup_.model.laser) laser_sweep_.ranges.resize(laser_.emplace(*setup_.model.laser, setup_.laser).size());
}

const Motion& Robot::plan(Duration now, Duration dt) { return planned_ = drive_.step(now, dt); }

void Robot::drive(const Surroundings& around) {
  const Moved moved = body_.move(planned_, around);
  if (moved.stopped_driving) drive_.stop_driving();
  if (moved.stopped_turning) drive_.stop_turning();
  odometry_.add(moved.motion);
}

void Robot::measure(const Surroundings& around, Duration before, Duration now) {
  body_.look(around);
  if (due(setup_.odometry_period, before, now)) measure_odometry(now);
  if (due(setup_.sonar_period, before, now)) measure_sonar(around, now);
  if (laser_ && due(setup_.laser_period, before, now)) measure_laser(around, now);
}

void Robot::measure_first(const Surroundings& around, Duration now) {
  body_.look(around);
  measure_sonar(around, now);
  if (laser_) measure_laser(around, now);
  measure_odometry(now);
}

void Robot::teleport(const Pose2& pose, const Surroundings& around) {
  require_finite(name(), pose);
  if (!body_.put(pose, around)) throw no_room(name(), "would stand", body_.outline(), pose, around);
  drive_.stop_driving();
  drive_.stop_turning();
}

void Robot::measure_sonar(const Surroundings& around, Duration now) {
  sonar_scan_.stamp = now;
  const auto scan = static_cast<std::uint64_t>(now / setup_.sonar_period);
  sonars_.measure(around, body_.pose(), random_, scan, sonar_scan_.ranges);
}

void Robot::measure_laser(const Surroundings& around, Duration now) {
  laser_sweep_.stamp = now;
  const auto sweep = static_cast<std::uint64_t>(now / setup_.laser_period);
  laser_->measure(around, body_.pose(), random_, sweep, laser_sweep_.ranges);
}

void Robot::measure_odometry(Duration now) {
  odometry_reading_ = {now, odometry_.pose(), odometry_.measured(drive_.speed())};
}

}  // namespace kervan::sim
