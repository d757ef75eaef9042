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
      setup.odometry_period <= Duration::zero() || setup.gyro_period <= Duration::zero())
    throw std::invalid_argument("robot " + setup.name + ": the periods of its sensors must be positive");
  if (setup.command_timeout <= Duration::zero())
    throw std::invalid_argument("robot " + setup.name + ": the time-out of its drive must be positive");
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
    return Body(setup.model.outline, setup.start, around, setup.model.drive_type == DriveType::differential);
  } catch (const std::invalid_argument&) {
    throw no_room(setup.name, "starts", setup.model.outline, setup.start, around);
  }
}

/// What `make` makes; if it refuses a setting it says of which robot.
template <class Make>
auto of(const RobotSetup& setup, Make make) {
  try {
    return make();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("robot " + setup.name + ": " + error.what());
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
      odometry_(of(setup_, [&] { return Odometry(setup_.start, setup_.odometry, setup_.model.track, random_); })),
      sonars_(of(setup_, [&] { return Sonars(setup_.model.sonars, setup_.sonar); })),
      bumpers_(of(setup_, [&] { return Bumpers(setup_.model, setup_.touch_range); })),
      pressed_(bumpers_.size()) {
  sonar_scan_.ranges.resize(sonars_.size());
  if (setup_.model.laser) {
    laser_ = of(setup_, [&] { return Laser(*setup_.model.laser, setup_.laser); });
    laser_sweep_.ranges.resize(laser_->size());
  }
  if (setup_.gyro) gyro_ = of(setup_, [&] { return Gyro(*setup_.gyro, random_); });
}

const Motion& Robot::plan(Duration now, Duration dt) {
  planned_at_ = now;
  return planned_ = drive_.step(now, dt);
}

void Robot::drive(const Surroundings& around) {
  const Moved moved = body_.move(planned_, around);
  if (moved.stopped_driving) drive_.stop_driving();
  if (moved.stopped_turning) drive_.stop_turning();
  stall_ = stalled(drive_.target(), planned_, moved.motion, setup_.model.track);
  odometry_.add(moved.motion, random_, planned_at_);
  if (gyro_) gyro_->add(moved.motion.turn);
}

void Robot::measure(const Surroundings& around, Duration before, Duration now) {
  SonarVolley sonars;
  measure(around, before, now, sonars);
  sonars.fire();
}

void Robot::measure(const Surroundings& around, Duration before, Duration now, SonarVolley& sonars) {
  body_.look(around);
  feel(around);
  if (due(setup_.odometry_period, before, now)) measure_odometry(now);
  if (due(setup_.sonar_period, before, now)) measure_sonar(around, now, sonars);
  if (laser_ && due(setup_.laser_period, before, now)) measure_laser(around, now);
  if (gyro_ && due(setup_.gyro_period, before, now)) measure_gyro(now);
}

void Robot::measure_first(const Surroundings& around, Duration now) {
  SonarVolley sonars;
  body_.look(around);
  feel(around);
  measure_sonar(around, now, sonars);
  sonars.fire();
  if (laser_) measure_laser(around, now);
  measure_odometry(now);
  if (gyro_) measure_gyro(now);
}

void Robot::teleport(const Pose2& pose, const Surroundings& around) {
  require_finite(name(), pose);
  if (!body_.put(pose, around)) throw no_room(name(), "would stand", body_.outline(), pose, around);
  drive_.stop_driving();
  drive_.stop_turning();
  stall_ = {};
}

Pose2 Robot::mounted(const Pose2& on_body) const {
  // Not a turn by 0: what is fixed to base_link stays where it is to the last bit.
  if (setup_.model.drive_type == DriveType::differential) return on_body;
  return Pose2{0.0, 0.0, geometry::angle_between(pose().yaw, body_.hull().yaw)} * on_body;
}

void Robot::measure_sonar(const Surroundings& around, Duration now, SonarVolley& sonars) {
  sonar_scan_.stamp = now;
  const auto round = static_cast<std::uint64_t>(now / setup_.sonar_period);
  sonars.add(sonars_, around, body_.hull(), random_, round, sonar_scan_.ranges);
}

void Robot::measure_laser(const Surroundings& around, Duration now) {
  laser_sweep_.stamp = now;
  const auto sweep = static_cast<std::uint64_t>(now / setup_.laser_period);
  laser_->measure(around, body_.hull(), random_, sweep, laser_sweep_.ranges);
}

void Robot::measure_odometry(Duration now) {
  odometry_reading_ = {now, odometry_.pose(), odometry_.measured(drive_.speed())};
}

void Robot::measure_gyro(Duration now) { gyro_reading_ = {now, gyro_->measure(random_, now)}; }

void Robot::feel(const Surroundings& around) {
  if (bumpers_.size() == 0) return;
  // No segment is nearer to anything than the hull, which is a single question, and often answered without asking.
  const double range = bumpers_.touch_range();
  if (body_.room(around, range) > range || around.room(body_.outline(), body_.hull()).all.distance > range)
    pressed_.assign(bumpers_.size(), false);
  else
    bumpers_.feel(around, body_.hull(), pressed_);
}

}  // namespace kervan::sim
