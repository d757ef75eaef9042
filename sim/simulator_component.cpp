#include <spdlog/spdlog.h>

#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/Contact.hpp"
#include "kervan_msgs/msg/Outline.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "rosgraph_msgs/msg/Clock.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "sensor_msgs/msg/Range.hpp"
#include "sim/files/robot_file.hpp"
#include "sim/files/world_file.hpp"
#include "sim/simulation.hpp"
#include "tf2_msgs/msg/TFMessage.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

constexpr double any_angle = 0.5 * std::numbers::pi;

struct RobotParams {
  FilePath model;
  Pose2 start;
  double drift = 0.0;
  Duration odometry_period = 50ms;
  Duration sonar_period = 100ms;
  Duration command_timeout = 250ms;
  std::int64_t sonar_rays = 32;
  double sonar_noise = 0.01;
  double sonar_drop_out = 0.0;
  double sonar_incidence_limit = any_angle;
  Duration laser_period = 100ms;
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

  RobotSetup setup(const std::string& name) const {
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
};

struct SimulatorParams {
  FilePath map;
  std::int64_t seed = 1;
  Duration step = 10ms;
  bool map_to_odom = true;
  std::map<std::string, RobotParams> robots;

  template <class Visitor>
  void describe(Visitor& v) {
    v(map, "map", {.help = "World file (worlds/lab.yaml), or a map of ROS (.yaml) or ARIA (.map).", .required = true});
    v(seed, "seed", {.min = 0, .max = 4294967295.0, .help = "Seed of everything random."});
    v(step, "step", {.min = 0.001, .max = 0.1, .help = "Time step of motion and contact."});
    v(map_to_odom, "map_to_odom",
      {.help = "Says on /tf that each odom coincides with map; false when a localisation knows better."});
    v(robots, "robots", {.help = "The robots by their names."});
  }
};

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

kervan_msgs::msg::Outline drawing(const World& world, Time stamp) {
  kervan_msgs::msg::Outline outline;
  geometry::set_header(outline.header, stamp, "map");
  const auto draw = [&outline](std::span<const Segment> segments) {
    for (const Segment& s : segments) {
      auto& drawn = outline.segments.emplace_back();
      drawn.x1 = s.a.x();
      drawn.y1 = s.a.y();
      drawn.x2 = s.b.x();
      drawn.y2 = s.b.y();
    }
  };
  draw(world.segments());
  for (const CellMap& map : world.bitmaps()) draw(map.edges().segments());
  for (const Circle& c : world.circles()) {
    auto& drawn = outline.circles.emplace_back();
    drawn.x = c.center.x();
    drawn.y = c.center.y();
    drawn.radius = c.radius;
  }
  for (const Box& box : world.boxes()) {
    auto& drawn = outline.polygons.emplace_back();
    for (const Vector2& corner : corners(box)) {
      auto& point = drawn.corners.emplace_back();
      point.x = static_cast<float>(corner.x());
      point.y = static_cast<float>(corner.y());
    }
  }
  return outline;
}

/// The ports of one robot. Its frames are <name>/odom and <name>/base_link.
class RobotPorts {
 public:
  RobotPorts(Component* owner, const std::string& name, bool has_laser)
      : odom_frame_(name + "/odom"),
        base_frame_(name + "/base_link"),
        laser_frame_(name + "/laser"),
        cmd_vel_(owner, name + "/cmd_vel", qos::command.optional(),
                 "Speed wanted of " + name + "; it brakes command_timeout after the last one."),
        sonar_(owner, name + "/sonar", qos::sensor, "What the sonars of " + name + " measure; +inf without an echo."),
        odom_(owner, name + "/odom", qos::sensor, "Pose and speed of " + name + " by its own wheels."),
        truth_(owner, name + "/truth", qos::state, "True pose in map and true speed of " + name + ", every step."),
        contact_(owner, name + "/contact", qos::event, "Each time " + name + " begins to touch something."),
        clearance_(owner, name + "/clearance", qos::latched,
                   "Least distance of the hull of " + name + " to any obstacle or robot so far.") {
    if (has_laser)
      scan_.emplace(owner, name + "/scan", qos::sensor,
                    "What the laser of " + name + ", if it has one, measures in the frame " + laser_frame_ + ".");
  }

  /// Hands the drive what has been commanded since the last step.
  void steer(Simulation& simulation, std::size_t robot) {
    for (const auto& command : cmd_vel_.take()) {
      if (command.disposed()) continue;
      const auto refused = simulation.robots()[robot].drive().refused_commands();
      simulation.command(robot, {command->twist.linear.x, command->twist.angular.z});
      last_refused_ = simulation.robots()[robot].drive().refused_commands() > refused;
    }
  }

  /// Publishes what is new at `now`.
  void publish(const Robot& robot, Duration simulated, Time now, tf2_msgs::msg::TFMessage& frames, bool map_to_odom) {
    publish_truth(robot, now);
    publish_contacts(robot, now);
    if (robot.odometry().stamp == simulated) {
      publish_odometry(robot.odometry(), now);
      if (map_to_odom) frames.transforms.push_back(transform(now, "map", odom_frame_, Pose2{}));
      frames.transforms.push_back(transform(now, odom_frame_, base_frame_, robot.odometry().pose));
      if (const auto& laser = robot.setup().model.laser)
        frames.transforms.push_back(transform(now, base_frame_, laser_frame_, laser->pose));
    }
    if (robot.sonar().stamp == simulated && !robot.sonar().ranges.empty()) publish_sonar(robot, now);
    if (scan_ && robot.laser().stamp == simulated) publish_scan(robot, now);
  }

  std::uint64_t contacts() const { return contacts_; }  ///< published so far
  bool last_refused() const { return last_refused_; }
  const std::string& command_name() const { return cmd_vel_.name(); }

 private:
  void publish_truth(const Robot& robot, Time now) {
    auto message = truth_.loan();
    geometry::set_header(message->header, now, "map");
    message->child_frame_id = base_frame_;
    set_odometry(*message, robot.pose(), robot.speed());
    truth_.publish(std::move(message));
  }

  void publish_odometry(const OdometryReading& reading, Time now) {
    auto message = odom_.loan();
    geometry::set_header(message->header, now, odom_frame_);
    message->child_frame_id = base_frame_;
    set_odometry(*message, reading.pose, reading.twist);
    odom_.publish(std::move(message));
  }

  void publish_sonar(const Robot& robot, Time now) {
    const SonarRing& ring = robot.setup().model.sonars;
    auto message = sonar_.loan();
    geometry::set_header(message->header, now, base_frame_);
    message->field_of_view = static_cast<float>(ring.field_of_view);
    message->min_range = static_cast<float>(ring.min_range);
    message->max_range = static_cast<float>(ring.max_range);
    message->readings.resize(ring.poses.size());
    for (std::size_t i = 0; i < ring.poses.size(); ++i) {
      auto& reading = message->readings[i];
      reading.x = static_cast<float>(ring.poses[i].x);
      reading.y = static_cast<float>(ring.poses[i].y);
      reading.yaw = static_cast<float>(ring.poses[i].yaw);
      reading.range = static_cast<float>(robot.sonar().ranges[i]);
    }
    sonar_.publish(std::move(message));
  }

  void publish_scan(const Robot& robot, Time now) {
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

  void publish_contacts(const Robot& robot, Time now) {
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
  std::uint64_t contacts_ = 0;
  double min_clearance_ = infinity;
  bool last_refused_ = false;
};

/// Simulates robots in a world (simulation.hpp). The first tick publishes what the sensors see at the start; each later
/// one moves the robots on to the present.
class SimulatorComponent final : public Component {
  const SimulatorParams& params_ = parameters<SimulatorParams>();
  Simulation simulation_ = simulation();
  std::deque<RobotPorts> ports_ = ports();
  Output<rosgraph_msgs::msg::Clock> clock_{this, "/clock", qos::state, "Time of the simulation, every step."};
  Output<tf2_msgs::msg::TFMessage> tf_{this, "/tf", qos::event, "odom to base_link, and map to odom if asked for."};
  Output<kervan_msgs::msg::Outline> outline_{this, "outline", qos::latched,
                                             "The true shape of the world, for drawing."};
  Timer tick_{this, params_.step, &SimulatorComponent::on_tick};
  std::optional<Time> start_;  // of the simulated time: the first tick

  Simulation simulation() const {
    const auto seed = static_cast<std::uint64_t>(params_.seed);
    // Without a map only the declarations are wanted (kervan describe).
    if (params_.map.path.empty()) return Simulation(std::make_shared<const World>(Obstacles{}), {}, seed);
    const auto world = std::make_shared<const World>(load_world(params_.map.path));
    std::vector<RobotSetup> setups;
    for (const auto& [name, robot] : params_.robots) {
      RobotSetup setup = robot.setup(name);
      for (const RobotSetup& other : setups) {
        const PlacedBody body(other.name, other.model.outline, other.start);
        if (!(clearance(body, setup.model.outline, setup.start).distance > 0.0))
          throw ParameterError("robots." + name + ".start", "the robot would stand in " + other.name);
      }
      setups.push_back(std::move(setup));
      if (!(world->clearance(setups.back().model.outline, robot.start).distance > 0.0))
        throw ParameterError("robots." + name + ".start", "the robot would stand in an obstacle of " + world->name());
    }
    try {
      return Simulation(world, std::move(setups), seed);
    } catch (const std::invalid_argument& error) {
      throw ParameterError("robots", error.what());
    }
  }

  std::deque<RobotPorts> ports() {
    std::deque<RobotPorts> ports;
    // Without a world there are no robots, only declarations: then the laser's is among them.
    const std::vector<Robot>& simulated = simulation_.robots();
    for (const auto& [name, robot] : params_.robots)
      ports.emplace_back(this, name, simulated.empty() || simulated[ports.size()].setup().model.laser.has_value());
    return ports;
  }

  void on_activate(Time now) override { outline_.publish(drawing(simulation_.world(), now)); }

  void on_tick(Time now) {
    for (std::size_t i = 0; i < ports_.size(); ++i) ports_[i].steer(simulation_, i);
    if (!start_) {
      start_ = now;
      publish(now);
    }
    // Steps that the container was too late for are made up here, so that the simulated time stays that of the clock.
    while (simulation_.now() + params_.step <= now - *start_) {
      simulation_.step(params_.step);
      publish(*start_ + simulation_.now());
    }
    report_refusals();
  }

  void publish(Time now) {
    auto clock = clock_.loan();
    clock->clock = geometry::to_message(now);
    clock_.publish(std::move(clock));
    auto frames = tf_.loan();
    for (std::size_t i = 0; i < ports_.size(); ++i) {
      const Robot& robot = simulation_.robots()[i];
      const std::uint64_t contacts = ports_[i].contacts();
      ports_[i].publish(robot, simulation_.now(), now, *frames, params_.map_to_odom);
      if (ports_[i].contacts() != contacts)
        log().info("{} touches {} at ({:.2f}, {:.2f}), contact {}", robot.name(),
                   robot.body().last_contact().other.empty() ? "something" : robot.body().last_contact().other,
                   robot.body().last_contact().point.x(), robot.body().last_contact().point.y(), ports_[i].contacts());
    }
    if (!frames->transforms.empty()) tf_.publish(std::move(frames));
  }

  void report_refusals() {
    for (const RobotPorts& ports : ports_)
      if (ports.last_refused()) return report_degraded(ports.command_name() + ": refused a command that is not finite");
    report_active();
  }
};

}  // namespace
}  // namespace kervan::sim

KERVAN_COMPONENT(kervan::sim::SimulatorComponent, "sim/world",
                 "Simulates robots, their sensors and the world around them.")
