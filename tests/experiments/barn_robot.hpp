/// A simulated robot that drives to a goal in a world it does not know, without components: the same algorithms with
/// the same periods, and the delays that the components have among each other under lockstep.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "components/control/dwa.hpp"
#include "components/control/route_follower.hpp"
#include "components/control/seen_points.hpp"
#include "components/mapping/laser_mapper.hpp"
#include "components/mapping/sonar_mapper.hpp"
#include "components/planning/grid_planner.hpp"
#include "components/planning/replan_policy.hpp"
#include "components/planning/route_watch.hpp"
#include "components/safety/collision_monitor.hpp"
#include "components/safety/drive_guard.hpp"
#include "sim/simulation.hpp"

namespace kervan::test {

struct BarnRobotParams {
  /// Out of which sensor the map is made; the other one is not listened to at all.
  std::variant<mapping::LaserMapperParams, mapping::SonarMapperParams> mapper =
      mapping::LaserMapperParams{.max_range = 8.0, .no_echo_limit = 8.0};
  planning::GridPlannerParams planner = {};
  double escape = 0.5;                                   ///< m, as planning/astar_grid has it
  Duration map_period = std::chrono::milliseconds(100);  ///< between two looks at the map
  planning::ReplanParams replan = {.deviation = 0.5, .tries = 1'000'000};
  double dearer = 0.2;  ///< as planning/astar_grid has it
  control::RouteFollowerParams follow = {.arrive_within = 0.3, .look_ahead = 0.8};
  control::SeenPointsParams seen = {};
  control::DwaParams dwa = {};
  std::optional<safety::CollisionMonitorParams> monitor = {};
  safety::DriveGuardParams guard = {};
};

class BarnRobot {
 public:
  BarnRobot(const BarnRobotParams& params, const geometry::Vector2& goal);

  /// Ten milliseconds of the only robot of the simulation.
  void step(sim::Simulation& simulation);

  const std::vector<geometry::Vector2>& route() const { return plan_.points; }

 private:
  using Mapper = std::variant<mapping::LaserMapper, mapping::SonarMapper>;

  void hear(const sim::Robot& robot);
  void hear_laser(const sim::Robot& robot);
  void hear_sonars(const sim::Robot& robot);
  geometry::Vector2 target() const { return follower_.waypoint().value_or(goal_); }
  void take_tiles();
  void look_beyond(const geometry::Vector2& place);
  void replan(Time now);

  BarnRobotParams params_;
  geometry::Vector2 goal_;
  Mapper mapper_;
  planning::GridPlanner planner_;
  grid::Occupancy cells_;
  grid::CellBox known_;
  planning::ReplanPolicy policy_;
  planning::RouteWatch watch_;
  planning::Plan plan_;
  bool planned_ = false;
  control::RouteFollower follower_;
  control::SeenPoints seen_;
  control::DynamicWindow dwa_;
  std::optional<safety::CollisionMonitor> monitor_;
  safety::DriveGuard guard_;
  std::optional<control::RobotState> state_;
  std::optional<Duration> odometry_stamp_, heard_;
  std::vector<float> ranges_;
  std::vector<geometry::Vector2> near_;    // of the last scan or round, in base_link, for the monitor
  std::vector<geometry::Vector2> echoes_;  // of the last round, in the frame of the odometry
  std::vector<std::int8_t> tile_;
};

}  // namespace kervan::test
