#include <spdlog/logger.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "components/grid/messages.hpp"
#include "components/observe/arbitration_log.hpp"
#include "components/observe/decimal.hpp"
#include "components/observe/map_drawing.hpp"
#include "components/observe/outline.hpp"
#include "components/observe/trajectory_csv.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "kervan_msgs/msg/ArbitrationState.hpp"
#include "kervan_msgs/msg/Contact.hpp"
#include "kervan_msgs/msg/MapTile.hpp"
#include "kervan_msgs/msg/MissionResult.hpp"
#include "kervan_msgs/msg/Outline.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "nav_msgs/msg/Path.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "tf2_msgs/msg/TFMessage.hpp"

namespace kervan::observe {
namespace {

using namespace std::chrono_literals;
using kervan_msgs::msg::MissionOutcome;

constexpr std::size_t most_map_bytes = std::size_t{1} << 28;

struct MapReportParams {
  std::vector<std::string> robots;
  std::vector<geometry::Vector2> nodes;
  std::string title = "map";
  double tolerance = 0.10;
  bool goals = true;
  Duration period = 100ms;
  Duration snapshots{};

  template <class Visitor>
  void describe(Visitor& v) {
    v(robots, "robots", {.help = "Names of the robots to record.", .required = true});
    v(nodes, "nodes", {.unit = "m", .help = "Waypoints to draw with their numbers; none: those of the routes."});
    v(title, "title", {.help = "Headline of the drawing."});
    v(tolerance, "tolerance", {.unit = "m", .min = 0.001, .max = 100.0, .help = "Radius of the circle around a goal."});
    v(goals, "goals", {.help = "Shows the robots' goals; not for robots that get one after the other."});
    v(period, "period", {.min = 0.001, .max = 60.0, .help = "Time between two rows of a robot."});
    v(snapshots, "snapshots",
      {.min = 0.0, .max = 3600.0, .help = "Draws what the sensors saw every so often; 0: never."});
  }
};

/// The sensors of one robot: what they saw at the beginning and every `period` after it.
class Sensors {
 public:
  Sensors(Component* owner, const std::string& name, Duration period)
      : period_(period),
        base_frame_(name + "/base_link"),
        sonar_(owner, name + "/sonar", qos::sensor.optional(), "What the sonars of " + name + " heard."),
        scan_(owner, name + "/scan", qos::sensor.optional(), "What the laser of " + name + " saw.") {}

  /// Remembers where the laser is mounted.
  void take_frame(const geometry_msgs::msg::TransformStamped& frame) {
    if (frame.header.frame_id != base_frame_) return;
    geometry_msgs::msg::Pose pose;
    pose.position.x = frame.transform.translation.x;
    pose.position.y = frame.transform.translation.y;
    pose.orientation = frame.transform.rotation;
    mounts_[frame.child_frame_id] = geometry::pose_of(pose);
  }

  /// What was measured at the time that is due or first after it; nothing before there is something.
  std::optional<Snapshot> look(const nav_msgs::msg::Odometry& truth, Time started) {
    const Time due = started + taken_ * period_;
    Snapshot snapshot;
    Time seen_at = Time::min();
    // The truth is newer than the measurement by less than its period: at its speed it was there.
    const auto pose_at = [&](Time stamp) {
      seen_at = std::max(seen_at, stamp);
      return moved_back(geometry::pose_of(truth.pose.pose), geometry::twist_of(truth.twist.twist),
                        seconds(geometry::time_of(truth.header.stamp) - stamp));
    };
    const auto* scan = scan_.latest();
    if (scan && geometry::time_of(scan->header.stamp) >= due && mounts_.contains(scan->header.frame_id)) {
      snapshot.pose = pose_at(geometry::time_of(scan->header.stamp));
      snapshot.seen = sweep(snapshot.pose * mounts_.at(scan->header.frame_id), scan->angle_min, scan->angle_increment,
                            scan->ranges);
    }
    const auto* sonar = sonar_.latest();
    if (sonar && geometry::time_of(sonar->header.stamp) >= due) {
      snapshot.pose = pose_at(geometry::time_of(sonar->header.stamp));
      for (const auto& reading : sonar->readings)
        if (reading.range <= sonar->max_range)
          snapshot.seen.push_back(cone(snapshot.pose * geometry::Pose2{reading.x, reading.y, reading.yaw},
                                       sonar->field_of_view, reading.range));
    }
    if (seen_at == Time::min()) return std::nullopt;
    snapshot.time = seconds(seen_at - started);
    taken_ = (seen_at - started) / period_ + 1;
    return snapshot;
  }

 private:
  Duration period_;
  std::int64_t taken_ = 0;  // the next one is due after so many periods
  std::string base_frame_;
  Input<kervan_msgs::msg::SonarArray> sonar_;
  Input<sensor_msgs::msg::LaserScan> scan_;
  std::map<std::string, geometry::Pose2> mounts_;  // in base_link, by the names of their frames
};

/// One robot: its ports, and what it has done so far.
class Subject {
 public:
  Subject(Component* owner, const std::string& name, Duration snapshots)
      : truth_(owner, name + "/truth", qos::state, "True pose and speed of " + name + "."),
        odom_(owner, name + "/odom", qos::sensor.optional(), "Where " + name + " believes to be."),
        route_(owner, name + "/route", qos::latched.optional(), "What is planned for " + name + "."),
        goal_(owner, name + "/goal", qos::latched.optional(), "Where " + name + " is to go."),
        contact_(owner, name + "/contact", qos::event.optional(), "Every touch of " + name + "."),
        arbitration_(owner, name + "/arbitration", qos::event.optional(), "Which behaviour drives " + name + ".") {
    drawn_.name = name;
    if (snapshots > Duration::zero()) sensors_.emplace(owner, name, snapshots);
  }

  void take_frame(const geometry_msgs::msg::TransformStamped& frame) {
    if (sensors_) sensors_->take_frame(frame);
  }

  /// Takes the newest samples and appends a row to `table`; nothing while the truth is unknown.
  void look(Time started, Time now, std::ostream& table) {
    for (const auto& contact : contact_.take()) drawn_.contacts.emplace_back(contact->point.x, contact->point.y);
    for (const auto& state : arbitration_.take()) {
      arbitration_log_.add(seconds(state.published() - started), state->behaviour, state->priority, state->waiting);
      in_charge_ = state->behaviour;
    }
    const auto* truth = truth_.latest();
    if (!truth) return;
    TrajectoryRow row{seconds(now - started), drawn_.name, geometry::pose_of(truth->pose.pose), std::nullopt,
                      geometry::twist_of(truth->twist.twist)};
    drawn_.truth.push_back(row.truth.position());
    if (in_charge_) colour(*in_charge_);
    if (const auto* odometry = odom_.latest()) {
      row.odom = geometry::pose_of(odometry->pose.pose);
      drawn_.odometry.push_back(row.odom->position());
    }
    if (table) table << to_csv(row) << '\n';
    if (!sensors_) return;
    if (auto snapshot = sensors_->look(*truth, started)) drawn_.snapshots.push_back(std::move(*snapshot));
  }

  /// Empty if nobody says which behaviour drives it. `end`: s since the start.
  std::string timeline(const std::string& title, double end) {
    if (arbitration_log_.empty()) return {};
    arbitration_log_.end(end);
    return to_svg(arbitration_log_, title, end);
  }

  DrawnRobot drawing(const MapReportParams& params, const kervan_msgs::msg::MissionResult* result) const {
    DrawnRobot robot = drawn_;
    robot.tolerance = params.tolerance;
    for (DrawnStretch& stretch : robot.stretches) stretch.colour = arbitration_log_.colour_of(stretch.behaviour);
    if (const auto* route = route_.latest())
      for (const auto& pose : route->poses) robot.route.push_back(geometry::position_of(pose.pose));
    if (const auto* goal = goal_.latest(); goal && params.goals) mark_goal(robot, geometry::position_of(goal->pose));
    if (result)
      for (const auto& figures : result->robots)
        if (figures.robot == robot.name) add_figures(robot, figures);
    return robot;
  }

 private:
  /// The last point of the path is `behaviour`'s.
  void colour(const std::string& behaviour) {
    auto& stretches = drawn_.stretches;
    const Polyline& truth = drawn_.truth;
    if (stretches.empty() || stretches.back().behaviour != behaviour) {
      stretches.push_back({behaviour, {}, {}});
      if (truth.size() > 1) stretches.back().path.push_back(truth[truth.size() - 2]);
    }
    stretches.back().path.push_back(truth.back());
  }

  static void mark_goal(DrawnRobot& robot, const geometry::Vector2& goal) {
    robot.goal = goal;
    const auto nearer = [&goal](const geometry::Vector2& a, const geometry::Vector2& b) {
      return (a - goal).norm() < (b - goal).norm();
    };
    const auto closest = std::min_element(robot.truth.begin(), robot.truth.end(), nearer);
    if (closest != robot.truth.end()) robot.closest = *closest;
  }

  static void add_figures(DrawnRobot& robot, const kervan_msgs::msg::RobotResult& figures) {
    robot.reached = figures.reached;
    robot.figures = {{"error", decimal(figures.error_m, 3) + " m"},
                     {"time", decimal(figures.time_s, 1) + " s"},
                     {"path", decimal(figures.path_m, 2) + " m"},
                     {"contacts", std::to_string(figures.contacts)}};
    if (std::isfinite(figures.min_clearance_m))
      robot.figures.emplace_back("least clearance", decimal(figures.min_clearance_m, 3) + " m");
    if (robot.goal && robot.closest)
      robot.figures.emplace_back("closest approach", decimal((*robot.closest - *robot.goal).norm(), 3) + " m");
  }

  DrawnRobot drawn_;
  Input<nav_msgs::msg::Odometry> truth_;
  Input<nav_msgs::msg::Odometry> odom_;
  Input<nav_msgs::msg::Path> route_;
  Input<geometry_msgs::msg::PoseStamped> goal_;
  Input<kervan_msgs::msg::Contact> contact_;
  Input<kervan_msgs::msg::ArbitrationState> arbitration_;
  ArbitrationLog arbitration_log_;
  std::optional<std::string> in_charge_;  // nothing: nobody has said who is
  std::optional<Sensors> sensors_;
};

/// Writes trajectory.csv while the run goes on and map.svg at its end, into the run's folder. What it does not receive
/// it leaves out; without a folder it writes nothing.
class MapReportComponent final : public Component {
  const MapReportParams& params_ = parameters<MapReportParams>();
  std::deque<Subject> robots_ = subjects();
  Input<kervan_msgs::msg::Outline> world_{this, "world", qos::latched.optional(), "True shape of the world."};
  Input<kervan_msgs::msg::Outline> moving_{this, "moving", qos::state.optional(), "Where the moving obstacles are."};
  Input<kervan_msgs::msg::MissionResult> result_{this, "result", qos::latched.optional(), "How the mission ended."};
  Input<kervan_msgs::msg::MapTile> tiles_{this, "tiles", qos::latched.optional(), "The map that is made, to be drawn."};
  std::optional<Input<tf2_msgs::msg::TFMessage>> tf_ = frames();
  Timer tick_{this, params_.period, &MapReportComponent::on_tick};
  std::ofstream table_;
  std::vector<DrawnMover> movers_;
  std::int64_t placed_ = 0;             // their places are due after so many snapshots
  std::optional<grid::Occupancy> map_;  // with the cells of the first tile
  std::uint64_t refused_tiles_ = 0;
  Time started_{};
  Time looked_{};

  std::deque<Subject> subjects() {
    std::deque<Subject> robots;
    for (std::size_t i = 0; i < params_.robots.size(); ++i) {
      const std::string& name = params_.robots[i];
      if (std::find(params_.robots.begin(), params_.robots.end(), name) - params_.robots.begin() !=
          static_cast<std::ptrdiff_t>(i))
        throw ParameterError("robots[" + std::to_string(i) + "]",
                             "'" + name + "' is there already; name each robot once");
      robots.emplace_back(this, name, params_.snapshots);
    }
    return robots;
  }

  std::optional<Input<tf2_msgs::msg::TFMessage>> frames() {
    if (params_.snapshots == Duration::zero()) return std::nullopt;
    return std::optional<Input<tf2_msgs::msg::TFMessage>>(std::in_place, this, "/tf", qos::event.optional(),
                                                          "Where the robots' lasers are mounted.");
  }

  void on_activate(Time now) override {
    started_ = now;
    if (run_folder().empty()) return;
    table_.open(run_folder() / "trajectory.csv");
    table_ << trajectory_header << '\n';
    if (!table_) report_degraded("trajectory.csv cannot be written in " + run_folder().string());
  }

  void on_tick(Time now) {
    looked_ = now;
    if (tf_)
      for (const auto& message : tf_->take())
        for (const auto& frame : message->transforms)
          for (auto& robot : robots_) robot.take_frame(frame);
    take_tiles();
    take_movers(now);
    for (auto& robot : robots_) robot.look(started_, now, table_);
  }

  /// Places are kept of the start and of the times of the snapshots.
  void take_movers(Time now) {
    const auto* moving = moving_.latest();
    if (!moving) return;
    const bool due =
        placed_ == 0 || (params_.snapshots > Duration::zero() && now - started_ >= placed_ * params_.snapshots);
    if (due) placed_ = params_.snapshots > Duration::zero() ? (now - started_) / params_.snapshots + 1 : 1;
    const DrawnWorld world = drawn_world(*moving);
    movers_.resize(world.polygons.size());
    for (std::size_t i = 0; i < movers_.size(); ++i) {
      const Polyline& corners = world.polygons[i];
      if (corners.empty()) continue;
      geometry::Vector2 middle = geometry::Vector2::Zero();
      for (const auto& corner : corners) middle += corner / static_cast<double>(corners.size());
      movers_[i].way.push_back(middle);
      if (due) movers_[i].places.push_back(corners);
    }
  }

  /// Those of now are the last.
  void place_movers() {
    const auto* moving = moving_.latest();
    if (!moving) return;
    const DrawnWorld world = drawn_world(*moving);
    for (std::size_t i = 0; i < movers_.size() && i < world.polygons.size(); ++i)
      movers_[i].places.push_back(world.polygons[i]);
  }

  void take_tiles() {
    constexpr double finest = 1e-3, coarsest = 1e3;  // m
    for (const auto& message : tiles_.take()) {
      if (message.disposed()) continue;
      const grid::TileView tile = grid::view_of(*message);
      if (!map_ && tile.resolution >= finest && tile.resolution <= coarsest)
        map_.emplace(tile.resolution, std::int8_t{-1}, most_map_bytes);
      if (!map_ || fault_of(tile, map_->resolution()) != grid::TileFault::none ||
          put(tile, *map_) == grid::Growth::refused)
        ++refused_tiles_;
    }
    if (refused_tiles_ > 0) report_degraded("tiles: those with cells or sizes of another kind are left out");
  }

  void on_shutdown(Time now) override {
    if (run_folder().empty()) return;
    if (now > looked_) on_tick(now);
    take_tiles();
    if (refused_tiles_ > 0) log().warn("left out {} tiles that do not fit", refused_tiles_);
    table_.close();
    MapDrawing drawing;
    drawing.title = params_.title;
    drawing.nodes = params_.nodes;
    if (const auto* world = world_.latest()) drawing.world = drawn_world(*world);
    place_movers();
    drawing.movers = movers_;
    const auto* result = result_.latest();
    drawing.result = !result                                             ? "aborted"
                     : result->result == MissionOutcome::MISSION_SUCCESS ? "success"
                     : result->result == MissionOutcome::MISSION_FAILED  ? "failed"
                                                                         : "aborted";
    drawing.subtitle = "ended after " + decimal(seconds(now - started_), 1) + " s";
    if (result && !result->reason.empty()) drawing.subtitle += "; " + result->reason;
    for (const auto& robot : robots_) drawing.robots.push_back(robot.drawing(params_, result));
    const auto has_goal = [](const DrawnRobot& robot) { return robot.goal.has_value(); };
    if (!result && std::none_of(drawing.robots.begin(), drawing.robots.end(), has_goal)) drawing.result.clear();
    drawing.map = std::move(map_);
    std::ofstream map(run_folder() / "map.svg");
    try {
      map << to_svg(drawing);
    } catch (const std::invalid_argument& error) {
      log().error("the map is not drawn: {}", error.what());
      drawing.map.reset();
      map << to_svg(drawing);
    }
    map.close();
    draw_timelines(seconds(now - started_));
    if (!table_ || !map) log().error("trajectory.csv or map.svg could not be written in {}", run_folder().string());
  }

  /// arbitration.svg, or arbitration-<robot>.svg for each of several robots, of those that are driven by behaviours.
  void draw_timelines(double end) {
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      const std::string& name = params_.robots[i];
      const std::string timeline = robots_[i].timeline(params_.title + ": who drives " + name, end);
      if (timeline.empty()) continue;
      const std::string file = robots_.size() == 1 ? "arbitration.svg" : "arbitration-" + name + ".svg";
      if (!(std::ofstream(run_folder() / file) << timeline))
        log().error("{} could not be written in {}", file, run_folder().string());
    }
  }
};

}  // namespace
}  // namespace kervan::observe

KERVAN_COMPONENT(kervan::observe::MapReportComponent, "observe/map_report",
                 "Writes the driven paths as trajectory.csv and a drawing of the run as map.svg.")
