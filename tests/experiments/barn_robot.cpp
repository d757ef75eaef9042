#include "tests/experiments/barn_robot.hpp"

#include <cmath>

#include "components/grid/tile.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry::Vector2;

using MapperParams = decltype(BarnRobotParams::mapper);

std::variant<mapping::LaserMapper, mapping::SonarMapper> made(const MapperParams& params) {
  if (const auto* laser = std::get_if<mapping::LaserMapperParams>(&params)) return mapping::LaserMapper(*laser);
  return mapping::SonarMapper(std::get<mapping::SonarMapperParams>(params));
}

std::size_t most_bytes(const MapperParams& params) {
  return std::visit([](const auto& mapper) { return mapper.most_bytes; }, params);
}

double resolution(const MapperParams& params) {
  return std::visit([](const auto& mapper) { return mapper.resolution; }, params);
}

}  // namespace

BarnRobot::BarnRobot(const BarnRobotParams& params, const Vector2& goal)
    : params_(params),
      goal_(goal),
      mapper_(made(params.mapper)),
      planner_(params.planner),
      cells_(resolution(params.mapper), -1, most_bytes(params.mapper)),
      policy_(params.replan),
      follower_(params.follow),
      seen_(params.seen),
      dwa_(params.dwa),
      monitor_(params.monitor),
      guard_(params.guard),
      tile_(std::size_t{grid::tile_side} * grid::tile_side) {}

void BarnRobot::step(sim::Simulation& simulation) {
  const Time now(simulation.now());
  if (simulation.now() % params_.guard.period == 0ms) simulation.command(0, guard_.step(now));
  if (simulation.now() % Duration(std::llround(params_.dwa.period * 1e9)) == 0ms && state_) {
    const geometry::Twist2 wanted = dwa_.step(*state_, target(), seen_.points()).twist;
    guard_.command(now, monitor_ ? monitor_->check(wanted, near_).twist : wanted);
  }
  // What is measured now is heard at the next tick.
  hear(simulation.robots().front());
  if (simulation.now() % params_.map_period == 0ms && state_) replan(now);
  simulation.step(10ms);
}

void BarnRobot::hear(const sim::Robot& robot) {
  if (odometry_stamp_ != robot.odometry().stamp) {
    odometry_stamp_ = robot.odometry().stamp;
    state_ = control::RobotState{robot.odometry().pose, robot.odometry().twist};
    follower_.advance(state_->pose.position());
  }
  std::holds_alternative<mapping::LaserMapper>(mapper_) ? hear_laser(robot) : hear_sonars(robot);
}

void BarnRobot::hear_laser(const sim::Robot& robot) {
  if (heard_ == robot.laser().stamp) return;
  heard_ = robot.laser().stamp;
  const sim::LaserMount& laser = *robot.setup().model.laser;
  ranges_.assign(robot.laser().ranges.begin(), robot.laser().ranges.end());
  const geometry::Scan scan{-0.5 * laser.field_of_view, sim::beam_spacing(laser), laser.min_range, laser.max_range,
                            ranges_};
  const geometry::Pose2 at = state_->pose * laser.pose;
  seen_.look(at, scan, Time(robot.laser().stamp));
  std::get<mapping::LaserMapper>(mapper_).add(at, scan);
  near_.clear();
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    const auto range = static_cast<double>(ranges_[i]);
    if (range >= scan.range_min && range < scan.range_max)
      near_.push_back(laser.pose * Vector2(range * geometry::heading(scan.angle_min +
                                                                     static_cast<double>(i) * scan.angle_increment)));
  }
}

void BarnRobot::hear_sonars(const sim::Robot& robot) {
  if (heard_ == robot.sonar().stamp) return;
  heard_ = robot.sonar().stamp;
  const sim::SonarRing& ring = robot.setup().model.sonars;
  near_.clear();
  echoes_.clear();
  for (std::size_t i = 0; i < ring.poses.size(); ++i) {
    const double range = robot.sonar().ranges[i];
    const geometry::Pose2& transducer = ring.poses[i];
    std::get<mapping::SonarMapper>(mapper_).add(state_->pose * transducer, range, {ring.min_range, ring.max_range});
    if (!(range >= 0.0 && range <= ring.max_range)) continue;
    echoes_.push_back(state_->pose * (transducer * Vector2(range, 0.0)));
    for (const double angle : {-0.5 * ring.field_of_view, 0.0, 0.5 * ring.field_of_view})
      near_.push_back(transducer * Vector2(range * geometry::heading(angle)));
  }
  seen_.add(echoes_, state_->pose.position(), Time(robot.sonar().stamp));
}

void BarnRobot::take_tiles() {
  std::visit(
      [this](auto& mapper) {
        for (const grid::Cell& tile : mapper.take_touched()) {
          const grid::CellBox box = grid::cells_of_tile(tile);
          mapper.read_percent(box, tile_);
          constexpr auto side = static_cast<std::uint32_t>(grid::tile_side);
          grid::put({tile, 0, mapper.resolution(), side, side, tile_}, cells_);
          cells_.touch(box);
          known_ = grid::united(known_, box);
        }
      },
      mapper_);
}

/// What no tile has shown yet is as good a way as any.
void BarnRobot::look_beyond(const Vector2& place) {
  const int margin = static_cast<int>(2.0 / cells_.resolution());
  const grid::Cell cell = grid::cell_of(place, cells_.resolution());
  const grid::CellBox box{cell.x - margin, cell.y - margin, 2 * margin + 1, 2 * margin + 1};
  cells_.cover(box);
  known_ = grid::united(known_, box);
}

/// As planning/astar_grid does when tiles have come.
void BarnRobot::replan(Time now) {
  take_tiles();
  const Vector2 robot = state_->pose.position();
  if (!planned_) policy_.begin(now);
  policy_.move(now, robot);
  if (policy_.route_is_good()) {
    planner_.update(cells_, known_);
    switch (watch_.look(planner_.costmap(), policy_.place().along(), params_.dearer)) {
      case planning::RouteChange::none: break;
      case planning::RouteChange::dearer: policy_.ask("the route has become dearer"); break;
      case planning::RouteChange::blocked: policy_.blocked(); break;
    }
  }
  if (policy_.step(now) != planning::ReplanPolicy::Step::plan) return;
  look_beyond(robot);
  look_beyond(goal_);
  planner_.update(cells_, known_);
  planner_.plan({robot, goal_, params_.escape, 0.25, 0}, plan_);
  planned_ = true;
  if (plan_.outcome == planning::Outcome::found) {
    policy_.planned(now, plan_.points);
    watch_.watch(planner_.costmap(), plan_.points);
    follower_.start(plan_.points);
  } else {
    policy_.failed(now, plan_.why);
    if (!policy_.route_is_good()) follower_.start({robot});
  }
  follower_.advance(robot);
}

}  // namespace kervan::test
