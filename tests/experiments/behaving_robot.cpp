#include "tests/experiments/behaving_robot.hpp"

#include <vector>

namespace kervan::test {

using namespace std::chrono_literals;

BehavingRobot::BehavingRobot(const BehavingParams& params) : senses_({.side = params.side}), follow_(params.follow) {}

void BehavingRobot::step(sim::Simulation& simulation) {
  const Time now(simulation.now());
  if (simulation.now() % 50ms == 0ms) tick(now, simulation);
  // What is measured now is heard at the next tick.
  const sim::Robot& robot = simulation.robots().front();
  std::vector<behavior::SonarReading> readings;
  const auto& ring = robot.setup().model.sonars;
  for (std::size_t i = 0; i < ring.poses.size(); ++i) readings.push_back({ring.poses[i], robot.sonar().ranges[i]});
  senses_.hear(readings, ring.max_range, now);
  senses_.move(robot.odometry().pose, robot.odometry().twist);
  std::vector<geometry::Vector2> pressed;
  for (std::size_t i = 0; i < robot.pressed().size(); ++i)
    if (robot.pressed()[i]) pressed.push_back(robot.bumpers().segments()[i].position());
  senses_.press(pressed, now);
  senses_.stall({robot.stall().left, robot.stall().right}, now);
  simulation.step(10ms);
}

template <class Behaviour>
bool BehavingRobot::ask(Behaviour& behaviour, const char* name, int priority, int hold,
                        const behavior::Situation& situation, Time now) {
  const behavior::Wish wish = senses_.unmirrored(behaviour.step(situation));
  arbiter_.take(now, {name, priority, hold, wish.active, 150ms, wish.twist, std::string(wish.why)});
  return wish.active;
}

void BehavingRobot::tick(Time now, sim::Simulation& simulation) {
  // Everybody works with what the others said a tick ago.
  simulation.command(0, guard_.step(now));
  decision_ = arbiter_.decide(now);
  guard_.command(now, decision_.twist);
  if (!senses_.complete()) return;
  const behavior::Situation situation = senses_.at(now);
  bool somebody = ask(find_, "wall_find", 10, 15, situation, now);
  somebody |= ask(follow_, "wall_follow", 20, 0, situation, now);
  somebody |= ask(convex_, "convex_corner", 30, 0, situation, now);
  somebody |= ask(side_, "side_avoid", 40, 0, situation, now);
  somebody |= ask(front_, "front_avoid", 50, 0, situation, now);
  somebody |= ask(bumper_, "bumper", 60, 0, situation, now);
  somebody |= ask(stall_, "stall_recover", 70, 0, situation, now);
  always_somebody_ = always_somebody_ && somebody;
}

}  // namespace kervan::test
