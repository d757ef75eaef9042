#include "sim/simulation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace kervan::sim {

namespace {
constexpr double doubt = 1e-9;  // m; more than the rounding of sums of distances
}

Simulation::Simulation(std::shared_ptr<const World> world, std::vector<RobotSetup> robots, std::uint64_t seed,
                       int threads)
    : world_(std::move(world)), seed_(seed), workers_(std::make_unique<workers::WorkerPool>(threads)) {
  for (const MovingObstacle& obstacle : world_->moving()) moving_.emplace_back(obstacle);
  for (const MovingBody& body : moving_) bodies_.add(body.obstacle().name, body.obstacle().outline, body.pose());
  robots_.reserve(robots.size());
  for (RobotSetup& setup : robots) add(std::move(setup));
  bodies_.sort();
  for_each(robots_.size(), [this](std::size_t i) { robots_[i].measure_first(around(i), now_); });
}

/// Those that are there already are in its way.
void Simulation::add(RobotSetup setup) {
  const auto place =
      std::lower_bound(order_.begin(), order_.end(), setup.name,
                       [this](std::size_t robot, const std::string& name) { return robots_[robot].name() < name; });
  if (place != order_.end() && robots_[*place].name() == setup.name)
    throw std::invalid_argument("two robots have the name " + setup.name);
  for (const MovingObstacle& moving : world_->moving())
    if (moving.name == setup.name)
      throw std::invalid_argument("robot " + setup.name + " has the name of a moving obstacle");
  Robot robot(std::move(setup), seed_, around(robots_.size()));
  bodies_.add(robot.name(), robot.body().outline(), robot.body().hull());
  order_.insert(place, robots_.size());
  robots_.push_back(std::move(robot));
  ways_.resize(robots_.size());
  has_driven_.resize(robots_.size());
}

void Simulation::spawn(RobotSetup robot) {
  add(std::move(robot));
  robots_.back().measure_first(around(robots_.size() - 1), now_);
}

void Simulation::remove(std::string_view name) {
  const std::size_t robot = place_of(name);
  robots_.erase(robots_.begin() + static_cast<std::ptrdiff_t>(robot));
  bodies_.remove(body_of(robot));
  std::erase(order_, robot);
  for (std::size_t& place : order_)
    if (place > robot) --place;
}

void Simulation::teleport(std::string_view name, const Pose2& pose) {
  const std::size_t robot = place_of(name);
  robots_[robot].teleport(pose, around(robot));
  bodies_.move(body_of(robot), robots_[robot].body().hull());
}

std::optional<std::size_t> Simulation::find(std::string_view name) const {
  const auto place =
      std::lower_bound(order_.begin(), order_.end(), name,
                       [this](std::size_t robot, std::string_view wanted) { return robots_[robot].name() < wanted; });
  if (place == order_.end() || robots_[*place].name() != name) return std::nullopt;
  return *place;
}

std::size_t Simulation::place_of(std::string_view name) const {
  if (const auto found = find(name)) return *found;
  throw std::invalid_argument("there is no robot " + std::string(name));
}

void Simulation::step(Duration dt) {
  assert(dt > Duration::zero());
  move_obstacles(dt);
  drive(dt);
  bodies_.sort();
  const std::span<const std::uint32_t> bodies = bodies_.by_place();
  for_each(bodies.size(), [this, bodies, dt](std::size_t i) {
    if (bodies[i] < moving_.size()) return;
    const std::size_t robot = bodies[i] - moving_.size();
    robots_[robot].measure(around(robot), now_, now_ + dt);
  });
  now_ += dt;
}

/// They mind the robots, and neither the walls nor each other: what they do among themselves is their script's matter.
void Simulation::move_obstacles(Duration dt) {
  if (moving_.empty()) return;
  const World nothing({});
  const Surroundings robots(nothing, bodies_, 0, moving_.size());
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    const auto touch = moving_[i].move(dt, robots);
    bodies_.move(i, moving_[i].pose());
    if (!touch) continue;
    if (const auto robot = find(touch->other)) robots_[*robot].touched_by(moving_[i].obstacle().name, touch->point);
  }
}

/// The robots drive one after the other. Who stays so far from everybody that it makes no difference when it drives may
/// do so at once, and beside others.
void Simulation::drive(Duration dt) {
  for_each(robots_.size(), [this, dt](std::size_t i) {
    const Motion& planned = robots_[i].plan(now_, dt);
    ways_[i] = std::abs(planned.distance);
  });
  const double longest_way = ways_.empty() ? 0.0 : *std::max_element(ways_.begin(), ways_.end());
  for_each(robots_.size(), [this, longest_way](std::size_t i) {
    Robot& robot = robots_[i];
    const Body& body = robot.body();
    const double near = body.heeds() + body.length(robot.planned()) + longest_way + doubt;
    has_driven_[i] = around(i).exact_room_among_bodies(body.outline(), body.hull(), near).all.distance >= near;
    if (!has_driven_[i]) return;
    robot.drive(*world_);
    bodies_.prepare(body_of(i), body.hull());
  });
  for (const std::size_t i : order_) {
    if (has_driven_[i]) {
      bodies_.go(body_of(i));
    } else {
      drive_among_others(i);
      bodies_.move(body_of(i), robots_[i].body().hull());
    }
  }
}

void Simulation::drive_among_others(std::size_t robot) {
  Robot& driving = robots_[robot];
  const std::uint64_t contacts = driving.body().contacts();
  driving.drive(around(robot));
  if (driving.body().contacts() == contacts) return;
  const Contact& contact = driving.body().last_contact();
  if (const auto other = find(contact.other)) robots_[*other].touched_by(driving.name(), contact.point);
}

}  // namespace kervan::sim
