#include <spdlog/spdlog.h>

#include <deque>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "rosgraph_msgs/msg/Clock.hpp"
#include "sim/component/outline_message.hpp"
#include "sim/component/robot_ports.hpp"
#include "sim/component/simulator_params.hpp"
#include "sim/files/world_file.hpp"
#include "sim/simulation.hpp"

namespace kervan::sim {
namespace {

constexpr Duration drawing_period = std::chrono::milliseconds(100);  // of what moves

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
  std::optional<Output<kervan_msgs::msg::Outline>> moving_ = moving();
  Timer tick_{this, params_.step, &SimulatorComponent::on_tick};
  std::optional<Time> start_;  // of the simulated time: the first tick

  Simulation simulation() const {
    const auto seed = static_cast<std::uint64_t>(params_.seed);
    // Without a map only the declarations are wanted (kervan describe).
    if (params_.map.path.empty()) return Simulation(std::make_shared<const World>(Obstacles{}), {}, seed);
    const auto world = std::make_shared<const World>(load_world(params_.map.path));
    std::vector<RobotSetup> setups;
    for (const auto& [name, robot] : params_.robots) setups.push_back(robot.setup(name));
    try {
      return Simulation(world, std::move(setups), seed);
    } catch (const NoRoom& error) {
      throw ParameterError(
          "robots." + error.robot() + ".start",
          "the robot would stand in " + (error.other().empty() ? "an obstacle of " + world->name() : error.other()));
    } catch (const std::invalid_argument& error) {
      throw ParameterError("robots", error.what());
    }
  }

  std::deque<RobotPorts> ports() {
    std::deque<RobotPorts> ports;
    const std::vector<Robot>& simulated = simulation_.robots();
    for (const auto& [name, robot] : params_.robots) {
      // Without a world there are no robots, only declarations: then everything that a robot may have is among them.
      RobotPorts::Equipment equipment{true, true, true, true};
      if (!simulated.empty()) {
        const RobotSetup& setup = simulated[ports.size()].setup();
        equipment = {setup.model.laser.has_value(), setup.gyro.has_value(), setup.model.fitted != BumperSet::none,
                     robot.stall_flags};
      }
      ports.emplace_back(this, name, equipment);
    }
    return ports;
  }

  std::optional<Output<kervan_msgs::msg::Outline>> moving() {
    // Without a world there are only declarations: then this is among them.
    if (!params_.map.path.empty() && simulation_.moving().empty()) return std::nullopt;
    return std::optional<Output<kervan_msgs::msg::Outline>>(
        std::in_place, this, "moving", qos::state,
        "Where the moving obstacles are, if the world has any, for drawing.");
  }

  void on_activate(Time now) override { outline_.publish(outline_message(simulation_.world(), now)); }

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
    if (moving_ && simulation_.now() % drawing_period == Duration::zero()) {
      auto outline = moving_->loan();
      set_outlines(simulation_.moving(), now, *outline);
      moving_->publish(std::move(outline));
    }
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
