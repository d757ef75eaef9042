#include <spdlog/spdlog.h>

#include <deque>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "rosgraph_msgs/msg/Clock.hpp"
#include "sim/component/outline_message.hpp"
#include "sim/component/requests.hpp"
#include "sim/component/robot_ports.hpp"
#include "sim/component/simulator_params.hpp"
#include "sim/files/world_file.hpp"
#include "sim/simulation.hpp"

namespace kervan::sim {
namespace {

constexpr Duration drawing_period = std::chrono::milliseconds(100);  // of what moves

/// A robot of the parameters, which may be in the world or not; its ports are always there.
struct Seat {
  Seat(Component* owner, const std::string& its_name, std::optional<RobotSetup> its_setup, bool present,
       const RobotPorts::Equipment& equipment)
      : name(its_name), setup(std::move(its_setup)), present_at_start(present), ports(owner, name, equipment) {}

  std::string name;
  std::optional<RobotSetup> setup;  ///< nothing if only the declarations are wanted
  bool present_at_start;
  RobotPorts ports;
  std::optional<std::size_t> place;  ///< in the simulation's list; nothing while it is not in the world
  bool fresh = true;                 ///< it came or was put elsewhere, and nobody has been told yet
};

/// Simulates robots in a world (simulation.hpp). The first tick publishes what the sensors see at the start; each later
/// one moves the robots on to the present. While the world is paused its time stands still, and that of the composition
/// goes on.
class SimulatorComponent final : public Component {
  const SimulatorParams& params_ = parameters<SimulatorParams>();
  std::shared_ptr<const World> world_ = world();
  std::deque<Seat> seats_ = seats();
  Simulation simulation_ = simulation();
  Output<rosgraph_msgs::msg::Clock> clock_{this, "/clock", qos::state, "Time of the simulation, every step."};
  Output<tf2_msgs::msg::TFMessage> tf_{this, "/tf", qos::event, "odom to base_link, and map to odom if asked for."};
  Output<kervan_msgs::msg::Outline> outline_{this, "outline", qos::latched,
                                             "The true shape of the world, for drawing."};
  std::optional<Output<kervan_msgs::msg::Outline>> moving_ = moving();
  Timer tick_{this, params_.step, &SimulatorComponent::on_tick};
  Request<NoArguments> pause_{this, "pause", &SimulatorComponent::on_pause,
                              "The world stands still: no motion, no measurement. The composition's time goes on."};
  Request<NoArguments> resume_{this, "resume", &SimulatorComponent::on_resume, "The world goes on."};
  Request<StepArguments> step_{this, "step", &SimulatorComponent::on_step,
                               "While it is paused: goes on for some steps, and stands still again."};
  Request<NoArguments> reset_{this, "reset", &SimulatorComponent::on_reset,
                              "All robots are as at the start, and so is everything random; paused stays paused."};
  Request<SpawnArguments> spawn_{this, "spawn", &SimulatorComponent::on_spawn, "Puts a robot into the world."};
  Request<RemoveArguments> remove_{this, "remove", &SimulatorComponent::on_remove, "Takes a robot out of the world."};
  Request<TeleportArguments> teleport_{this, "teleport", &SimulatorComponent::on_teleport,
                                       "Lifts a robot and puts it down elsewhere; its odometry does not notice."};
  std::optional<Time> zero_;  // when the world's time was 0, had it never stood still; set by the first tick
  bool paused_ = false;
  std::int64_t steps_left_ = 0;  // while paused

  std::shared_ptr<const World> world() const {
    // Without a map only the declarations are wanted (kervan describe).
    if (params_.map.path.empty()) return std::make_shared<const World>(Obstacles{});
    return std::make_shared<const World>(load_world(params_.map.path));
  }

  std::deque<Seat> seats() {
    std::deque<Seat> seats;
    for (const auto& [name, robot] : params_.robots) {
      // Without a map there are no robots, only declarations: then everything that a robot may have is among them.
      std::optional<RobotSetup> setup;
      RobotPorts::Equipment equipment{true, true, true, true};
      if (!params_.map.path.empty()) {
        setup = robot.setup(name);
        equipment = {setup->model.laser.has_value(), setup->gyro.has_value(), setup->model.fitted != BumperSet::none,
                     robot.stall_flags};
      }
      seats.emplace_back(this, name, std::move(setup), robot.present, equipment);
    }
    return seats;
  }

  /// The world as it is at the start.
  Simulation simulation() {
    std::vector<RobotSetup> setups;
    for (const Seat& seat : seats_)
      if (seat.setup && seat.present_at_start) setups.push_back(*seat.setup);
    try {
      Simulation simulation(world_, std::move(setups), static_cast<std::uint64_t>(params_.seed));
      find_places(simulation);
      return simulation;
    } catch (const NoRoom& error) {
      throw ParameterError("robots." + error.robot() + ".start", "the robot would stand in " + in_the_way(error));
    } catch (const std::invalid_argument& error) {
      throw ParameterError("robots", error.what());
    }
  }

  std::string in_the_way(const NoRoom& error) const {
    return error.other().empty() ? "an obstacle of " + world_->name() : error.other();
  }

  void find_places(const Simulation& simulation) {
    for (Seat& seat : seats_) seat.place = simulation.find(seat.name);
  }

  std::optional<Output<kervan_msgs::msg::Outline>> moving() {
    // Without a world there are only declarations: then this is among them.
    if (!params_.map.path.empty() && world_->moving().empty()) return std::nullopt;
    return std::optional<Output<kervan_msgs::msg::Outline>>(
        std::in_place, this, "moving", qos::state,
        "Where the moving obstacles are, if the world has any, for drawing.");
  }

  void on_activate(Time now) override { outline_.publish(outline_message(*world_, now)); }

  void on_tick(Time now) {
    for (Seat& seat : seats_) seat.ports.steer(simulation_, seat.place);
    const bool first = !zero_;
    if (first) zero_ = now;
    const bool stands = paused_ && steps_left_ == 0;
    if (paused_) zero_ = now - simulation_.now() - (stands ? Duration::zero() : params_.step);
    if (stands || (first && !paused_)) publish_clock(now);
    publish(*zero_ + simulation_.now(), [](const Seat& seat) { return seat.fresh; });
    if (first) publish_moving(now);
    // Steps that the container was too late for are made up here, so that the simulated time stays that of the clock.
    while (simulation_.now() + params_.step <= now - *zero_) {
      simulation_.step(params_.step);
      if (paused_) --steps_left_;
      const Time present = *zero_ + simulation_.now();
      publish_clock(present);
      publish(present, [](const Seat&) { return true; });
      if (simulation_.now() % drawing_period == Duration::zero()) publish_moving(present);
    }
    report();
  }

  void publish_clock(Time now) {
    auto clock = clock_.loan();
    clock->clock = geometry::to_message(now);
    clock_.publish(std::move(clock));
  }

  void publish_moving(Time now) {
    if (!moving_) return;
    auto outline = moving_->loan();
    set_outlines(simulation_.moving(), now, *outline);
    moving_->publish(std::move(outline));
  }

  /// Tells what there is to tell at `now` of the robots that are wanted.
  template <class Wanted>
  void publish(Time now, Wanted&& wanted) {
    auto frames = tf_.loan();
    for (Seat& seat : seats_) {
      if (!seat.place || !wanted(seat)) continue;
      seat.fresh = false;
      const Robot& robot = simulation_.robots()[*seat.place];
      const std::uint64_t contacts = seat.ports.contacts();
      seat.ports.publish(robot, simulation_.now(), now, *frames, params_.map_to_odom);
      if (seat.ports.contacts() != contacts)
        log().info("{} touches {} at ({:.2f}, {:.2f}), contact {}", robot.name(),
                   robot.body().last_contact().other.empty() ? "something" : robot.body().last_contact().other,
                   robot.body().last_contact().point.x(), robot.body().last_contact().point.y(), seat.ports.contacts());
    }
    if (!frames->transforms.empty()) tf_.publish(std::move(frames));
  }

  void report() {
    for (const Seat& seat : seats_)
      if (seat.ports.last_refused())
        return report_degraded(seat.ports.command_name() + ": refused a command that is not finite");
    if (paused_) return report_degraded("paused on request");
    report_active();
  }

  std::string on_pause(const NoArguments&, Time) {
    if (paused_ && steps_left_ == 0) return "already paused";
    paused_ = true;
    steps_left_ = 0;
    report();
    return "";
  }

  std::string on_resume(const NoArguments&, Time) {
    if (!paused_) return "already running";
    paused_ = false;
    steps_left_ = 0;
    report();
    return "";
  }

  std::string on_step(const StepArguments& arguments, Time) {
    if (!paused_) throw RequestRefused("the world is not paused; pause it first");
    steps_left_ += arguments.steps;
    return "";
  }

  std::string on_reset(const NoArguments&, Time) {
    simulation_ = simulation();
    for (Seat& seat : seats_) restart(seat);
    zero_.reset();
    steps_left_ = 0;
    return "";
  }

  std::string on_spawn(const SpawnArguments& arguments, Time) {
    Seat& seat = find(arguments.robot);
    if (seat.place) {
      if (!arguments.pose) return "already there";
      throw RequestRefused("'" + arguments.robot + "' is in the world already; teleport puts it elsewhere");
    }
    RobotSetup setup = *seat.setup;
    if (arguments.pose) setup.start = *arguments.pose;
    unless_no_room([&] { simulation_.spawn(std::move(setup)); });
    find_places(simulation_);
    restart(seat);
    return "";
  }

  std::string on_remove(const RemoveArguments& arguments, Time) {
    Seat& seat = find(arguments.robot);
    if (!seat.place) return "not there any more";
    simulation_.remove(arguments.robot);
    find_places(simulation_);
    restart(seat);
    return "";
  }

  std::string on_teleport(const TeleportArguments& arguments, Time) {
    Seat& seat = find(arguments.robot);
    if (!seat.place) throw RequestRefused("'" + arguments.robot + "' is not in the world; spawn puts it there");
    unless_no_room([&] { simulation_.teleport(arguments.robot, arguments.pose); });
    seat.fresh = true;
    return "";
  }

  static void restart(Seat& seat) {
    seat.ports.restart();
    seat.fresh = true;
  }

  Seat& find(const std::string& robot) {
    std::vector<std::string> names;
    for (Seat& seat : seats_) {
      if (seat.name == robot) return seat;
      names.push_back(seat.name);
    }
    const auto near = nearest(robot, names);
    std::string known;
    for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
    throw RequestRefused("there is no robot '" + robot + "' in the parameters" +
                         (near ? "; did you mean '" + *near + "'?" : ";") +
                         " robots: " + (known.empty() ? "none" : known));
  }

  /// Refuses what the simulation refuses; then nothing has changed.
  template <class Work>
  void unless_no_room(Work&& work) const {
    try {
      work();
    } catch (const NoRoom& error) {
      throw RequestRefused("'" + error.robot() + "' would stand in " + in_the_way(error));
    } catch (const std::invalid_argument& error) {
      throw RequestRefused(error.what());
    }
  }
};

}  // namespace
}  // namespace kervan::sim

KERVAN_COMPONENT(kervan::sim::SimulatorComponent, "sim/world",
                 "Simulates robots, their sensors and the world around them.")
