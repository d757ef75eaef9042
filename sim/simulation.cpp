#include "sim/simulation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
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
  for_each_robot([this](std::size_t i) { robots_[i].measure_first(around(i), now_); });
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
  is_alone_.resize(robots_.size());
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
  bodies_.sort();
  drive(dt);
  bodies_.sort();
  measure(dt);
  now_ += dt;
}

/// Neighbours fire their sonars together.
void Simulation::measure(Duration dt) {
  const std::span<const std::uint32_t> bodies = bodies_.by_place();
  constexpr std::size_t together = SonarVolley::most;
  workers_->for_each((bodies.size() + together - 1) / together, worth_sharing / together, [&](std::size_t volley) {
    SonarVolley sonars;
    for (const std::uint32_t body :
         bodies.subspan(volley * together).first(std::min(together, bodies.size() - volley * together))) {
      if (body < moving_.size()) continue;
      const std::size_t robot = body - moving_.size();
      robots_[robot].measure(around(robot), now_, now_ + dt, sonars);
    }
    sonars.fire();
  });
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

/// The robots drive one after the other. Who stays so far from somebody that it makes no difference which of them
/// drives first may do so beside that one.
void Simulation::drive(Duration dt) {
  for_each_robot([this, dt](std::size_t i) { ways_[i] = robots_[i].body().length(robots_[i].plan(now_, dt)); });
  const double longest_way = ways_.empty() ? 0.0 : *std::max_element(ways_.begin(), ways_.end());
  groups_.reset(bodies_.size(), moving_.size());
  for_each_robot([this, longest_way](std::size_t i) { find_others_near(i, longest_way); });
  groups_.sort(order_);
  bodies_.make_way(longest_way + doubt);
  for_each_robot([this](std::size_t i) {
    groups_.visit_led_by(body_of(i), [this](std::size_t body) { drive(body - moving_.size()); });
  });
}

/// Finds out whether somebody may come so near to the robot in this step that the robot heeds it.
///
/// What is compared is Bodies::separation before the step, since Body::move looks at no more than that in a step in
/// which nothing is near. A body that goes a way w changes it by no more than w, and by (r + r') w pi / 2 / d because
/// the line through the centres, a distance d apart, turns; r and r' are the radii of the two bodies.
void Simulation::find_others_near(std::size_t robot, double longest_way) {
  const std::size_t self = body_of(robot);
  const double heeds = robots_[robot].body().heeds() + ways_[robot] + doubt, radius = bodies_.radius(self);
  constexpr double turning = 0.5 * std::numbers::pi, most = 1.0 + turning;  // for bodies whose discs do not meet
  bool alone = true;
  const Vector2 extent = Vector2::Constant(heeds + most * longest_way + radius + bodies_.largest_radius());
  const Vector2 center = bodies_.center(self);
  bodies_.visit_box(center - extent, center + extent, [&](std::size_t other) {
    if (other == self) return;
    const bool moves_now = other >= moving_.size();
    const double way = moves_now ? ways_[other - moving_.size()] : 0.0;
    const double distance = (bodies_.center(other) - center).norm(), radii = radius + bodies_.radius(other);
    if (distance - radii >= heeds + most * way) return;
    if (way < distance && bodies_.separation(self, other) >= heeds + (1.0 + turning * radii / distance) * way) return;
    alone = false;
    if (moves_now) groups_.join(self, other);
  });
  is_alone_[robot] = alone;
}

/// What the robot touches belongs to its group.
void Simulation::drive(std::size_t robot) {
  Robot& driving = robots_[robot];
  if (is_alone_[robot]) {
    driving.drive(*world_);
  } else {
    const std::uint64_t contacts = driving.body().contacts();
    driving.drive(Surroundings(*world_, bodies_, body_of(robot), groups_));
    if (driving.body().contacts() != contacts) {
      const Contact& contact = driving.body().last_contact();
      if (const auto other = find(contact.other)) robots_[*other].touched_by(driving.name(), contact.point);
    }
  }
  bodies_.move_on(body_of(robot), driving.body().hull());
}

}  // namespace kervan::sim
