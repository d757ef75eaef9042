/// A world with robots in it, and its time. Values in, values out: no clock, no input or output.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "framework/workers/worker_pool.hpp"
#include "sim/moving_body.hpp"
#include "sim/robot.hpp"
#include "sim/world.hpp"

namespace kervan::sim {

/// The same world, robots, seed, commands and steps give the same results to the last bit, on any number of threads,
/// and those of one robot do not depend on where it stands in the list. Within a step the moving obstacles go first,
/// then the robots drive one after the other, in the order of their names; then all of them measure. They see each
/// other's bodies and cannot drive through each other. To begin anew, build another one out of the same world and
/// setups: nothing is left over from one to the next.
class Simulation {
 public:
  /// The world may be shared with other simulations. Throws NoRoom or another std::invalid_argument, naming the robot,
  /// if it has the name of another one or of a moving obstacle, stands in or against something, or cannot be as its
  /// setup wants it. Steps use
  /// `threads` threads, at least 1: the caller's and others of its own.
  Simulation(std::shared_ptr<const World> world, std::vector<RobotSetup> robots, std::uint64_t seed, int threads = 1);

  /// Adds a robot behind those that are there. It stands still at its start, measures with all its sensors at once, as
  /// the others did at time 0, and from then on when they are due. Throws as the constructor does, and changes nothing
  /// then.
  void spawn(RobotSetup robot);

  /// Takes the robot away; those behind it in the list move up by one. Throws std::invalid_argument if nobody has the
  /// name.
  void remove(std::string_view name);

  /// Lifts the robot and puts it down at `pose`, of base_link in map, where it stands still until the next step. Its
  /// wheels have not turned, so its odometry does not notice; a command that is still fresh goes on. Throws NoRoom if
  /// something is in the way there, or another std::invalid_argument if nobody has the name or the pose is not finite,
  /// and changes nothing then.
  void teleport(std::string_view name, const Pose2& pose);

  /// The place of a robot in the list.
  std::optional<std::size_t> find(std::string_view name) const;

  /// The robot takes this speed from the next step on, and for at most its command_timeout.
  void command(std::size_t robot, const Twist2& wanted) { robots_.at(robot).command(wanted, now_); }

  /// Everything moves on by `dt`, which must be positive. Steps of 10 ms are usual; a robot cannot pass through a wall
  /// however long the step is.
  void step(Duration dt);

  Duration now() const { return now_; }
  const World& world() const { return *world_; }

  /// The world's moving obstacles, in their order, where they are now.
  const std::vector<MovingBody>& moving() const { return moving_; }

  const std::vector<Robot>& robots() const { return robots_; }

 private:
  std::size_t body_of(std::size_t robot) const { return moving_.size() + robot; }
  Surroundings around(std::size_t robot) const { return {*world_, bodies_, body_of(robot)}; }
  static constexpr std::size_t worth_sharing = 16;  // robots; waking somebody takes longer than doing less than this
  /// Calls work(robot) for all of them, shared out among the threads, neighbours one after the other.
  template <class Work>
  void for_each_robot(Work&& work) const {
    const std::span<const std::uint32_t> bodies = bodies_.by_place();
    workers_->for_each(bodies.size(), worth_sharing, [&](std::size_t i) {
      if (bodies[i] >= moving_.size()) work(bodies[i] - moving_.size());
    });
  }
  void add(RobotSetup setup);
  std::size_t place_of(std::string_view name) const;
  void move_obstacles(Duration dt);
  void drive(Duration dt);
  void measure(Duration dt);
  void find_others_near(std::size_t robot, double longest_way);
  void drive(std::size_t robot);

  std::shared_ptr<const World> world_;
  std::uint64_t seed_;
  std::unique_ptr<workers::WorkerPool> workers_;
  std::vector<MovingBody> moving_;
  std::vector<Robot> robots_;
  Bodies bodies_;                   // of the moving obstacles, then of the robots, in their order
  std::vector<std::size_t> order_;  // of the robots by their names
  Duration now_{0};

  // Within a step.
  Groups groups_;                        // of bodies that may meet; moving obstacles belong to all of them
  std::vector<double> ways_;             // m; no point of the robot's body wants to go farther
  std::vector<unsigned char> is_alone_;  // nobody is near the robot; not bool: several threads write them
};

}  // namespace kervan::sim
