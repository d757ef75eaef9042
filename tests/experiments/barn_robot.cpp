#include "tests/experiments/barn_robot.hpp"

#include "components/grid/tile.hpp"
#include "components/planning/string_pulling.hpp"

namespace kervan::test {

using namespace std::chrono_literals;
using geometry::Vector2;

BarnRobot::BarnRobot(const BarnRobotParams& params, const Vector2& goal)
    : params_(params),
      goal_(goal),
      mapper_(params.mapper),
      planner_(params.planner),
      cells_(params.mapper.resolution, -1, params.mapper.most_bytes),
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
  if (simulation.now() % Duration(static_cast<std::int64_t>(params_.dwa.period * 1e9)) == 0ms && state_) {
    last_ = dwa_.step(*state_, target(), seen_.points());
    guard_.command(now, monitor_ ? monitor_->check(last_.twist, echoes_).twist : last_.twist);
  }
  // What is measured now is heard at the next tick.
  hear(simulation.robots().front());
  if (params_.plans && simulation.now() % params_.map_period == 0ms && state_) replan(now);
  simulation.step(10ms);
}

void BarnRobot::hear(const sim::Robot& robot) {
  if (odometry_stamp_ != robot.odometry().stamp) {
    odometry_stamp_ = robot.odometry().stamp;
    state_ = control::RobotState{robot.odometry().pose, robot.odometry().twist};
    follower_.advance(state_->pose.position());
  }
  if (scan_stamp_ == robot.laser().stamp) return;
  scan_stamp_ = robot.laser().stamp;
  const auto& laser = *robot.setup().model.laser;
  ranges_.assign(robot.laser().ranges.begin(), robot.laser().ranges.end());
  const geometry::Scan scan{-0.5 * laser.field_of_view, sim::beam_spacing(laser), laser.min_range, laser.max_range,
                            ranges_};
  const geometry::Pose2 at = state_->pose * laser.pose;
  seen_.look(at, scan, Time(robot.laser().stamp));
  if (params_.plans) mapper_.add(at, scan);
  echoes_.clear();
  for (std::size_t i = 0; i < ranges_.size(); ++i)
    if (ranges_[i] >= static_cast<float>(scan.range_min) && ranges_[i] < static_cast<float>(scan.range_max))
      echoes_.push_back(laser.pose *
                        Vector2(static_cast<double>(ranges_[i]) *
                                geometry::heading(scan.angle_min + static_cast<double>(i) * scan.angle_increment)));
}

void BarnRobot::take_tiles() {
  for (const grid::Cell& tile : mapper_.take_touched()) {
    const grid::CellBox box = grid::cells_of_tile(tile);
    mapper_.read_percent(box, tile_);
    constexpr auto side = static_cast<std::uint32_t>(grid::tile_side);
    grid::put({tile, 0, params_.mapper.resolution, side, side, tile_}, cells_);
    cells_.touch(box);
    known_ = grid::united(known_, box);
  }
}

/// What no tile has shown yet is as good a way as any.
void BarnRobot::look_beyond(const Vector2& place) {
  const int margin = static_cast<int>(2.0 / params_.mapper.resolution);
  const grid::Cell cell = grid::cell_of(place, params_.mapper.resolution);
  const grid::CellBox box{cell.x - margin, cell.y - margin, 2 * margin + 1, 2 * margin + 1};
  cells_.cover(box);
  known_ = grid::united(known_, box);
}

/// As planning/astar_grid does when tiles have come.
void BarnRobot::replan(Time now) {
  take_tiles();
  const Vector2 robot = state_->pose.position();
  if (plans_ == 0) policy_.begin(now);
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
  ++plans_;
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
