#include <spdlog/spdlog.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "components/control/recovery.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "kervan_msgs/msg/ReplanRequest.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "nav_msgs/msg/Path.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "std_msgs/msg/Header.hpp"

namespace kervan::control {
namespace {

using namespace std::chrono_literals;

struct RecoveryComponentParams {
  Duration period = 100ms;
  RecoveryParams recovery;
  geometry::Pose2 mount;

  template <class Visitor>
  void describe(Visitor& v) {
    RecoveryParams& r = recovery;
    v(period, "period", {.min = 0.01, .max = 1.0, .help = "Time between two looks at the robot."});
    v(r.hull.front, "front", {.unit = "m", .min = 0.0, .max = 5.0, .help = "From base_link to the nose."});
    v(r.hull.rear, "rear", {.unit = "m", .min = 0.0, .max = 5.0, .help = "From base_link to the tail."});
    v(r.hull.half_width, "half_width", {.unit = "m", .min = 0.0, .max = 5.0, .help = "From base_link to a side."});
    v(r.hull.turning, "turning_radius",
      {.unit = "m",
       .min = 0.0,
       .max = 5.0,
       .help = "Of the circle that the robot sweeps when it turns on the spot; 0: that of its corners."});
    v(mount, "mount", {.min = -10.0, .max = 10.0, .help = "Pose of the laser in base_link."});
    v(r.at_target, "at_target",
      {.unit = "m",
       .min = 0.0,
       .max = 10.0,
       .help = "Nearer to its waypoint than this a robot may stand.",
       .live = true});
    v(r.standing, "standing",
      {.min = 0.5, .max = 600.0, .help = "Trapped: it did not move or turn for so long.", .live = true});
    v(r.moved, "moved", {.unit = "m", .min = 0.001, .max = 5.0, .help = "Less than this is no motion.", .live = true});
    v(r.turned_away, "turned_away",
      {.min = 0.5, .max = 600.0, .help = "Trapped: it drove away from its waypoint for so long.", .live = true});
    v(r.reversals, "reversals",
      {.min = 2, .max = 1000, .help = "Trapped: its commands changed sign so often on the spot.", .live = true});
    v(r.area, "area", {.unit = "m", .min = 0.1, .max = 100.0, .help = "Radius of a small area.", .live = true});
    v(r.circling, "circling",
      {.min = 0.5, .max = 3600.0, .help = "Trapped: it did not leave a small area for so long.", .live = true});
    v(r.free, "free",
      {.unit = "m",
       .min = 0.1,
       .max = 100.0,
       .help = "So far from where it was trapped a robot is free.",
       .live = true});
    v(r.speed, "speed", {.unit = "m/s", .min = 0.01, .max = 2.0, .help = "Of manoeuvres.", .live = true});
    v(r.turn_rate, "turn_rate", {.unit = "rad/s", .min = 0.01, .max = 5.0, .help = "Of manoeuvres.", .live = true});
    v(r.back, "back",
      {.unit = "m", .min = 0.0, .max = 5.0, .help = "Farthest it backs up or pulls ahead.", .live = true});
    v(r.margin, "margin",
      {.unit = "m", .min = 0.0, .max = 1.0, .help = "No manoeuvre comes nearer to an obstacle.", .live = true});
    v(r.manoeuvre, "manoeuvre",
      {.min = 0.1, .max = 60.0, .help = "Longest turn, backing up or pulling ahead.", .live = true});
    v(r.following, "following", {.min = 0.1, .max = 600.0, .help = "Longest along a wall.", .live = true});
    v(r.trial, "trial", {.min = 0.0, .max = 60.0, .help = "The controller's time after each rung.", .live = true});
    v(r.most_rungs, "most_rungs",
      {.min = 0, .max = 10'000, .help = "For one goal; then it is given up.", .live = true});
  }
};

/// Passes the controller's commands on, and takes over while it frees a trapped robot (recovery.hpp).
class RecoveryComponent final : public Component {
  const RecoveryComponentParams& params_ = parameters<RecoveryComponentParams>();
  Recovery recovery_{params_.recovery};
  Input<geometry_msgs::msg::TwistStamped> wanted_{this, "cmd_vel_wanted", qos::command.max_age(250ms),
                                                  &RecoveryComponent::on_command, "Speed that the controller wants."};
  Input<geometry_msgs::msg::PoseStamped> waypoint_{this, "waypoint", qos::latched, "Where the controller drives."};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor.max_age(500ms), "Where the robot is."};
  Input<sensor_msgs::msg::LaserScan> scan_{this, "scan", qos::sensor.max_age(500ms).optional(),
                                           "Room around the robot."};
  Input<kervan_msgs::msg::SonarArray> sonar_{this, "sonar", qos::sensor.max_age(500ms).optional(),
                                             &RecoveryComponent::on_sonar, "Room around the robot."};
  Input<kervan_msgs::msg::GoalStatus> status_{this, "goal_status", qos::latched.optional(),
                                              &RecoveryComponent::on_status,
                                              "With another goal everything counts anew."};
  Input<nav_msgs::msg::Path> route_{this, "route", qos::latched.optional(),
                                    "An empty one: there is no way to the goal for the time being."};
  Output<geometry_msgs::msg::TwistStamped> cmd_vel_{this, "cmd_vel_raw", qos::command, "Speed wanted of base_link."};
  Output<kervan_msgs::msg::ReplanRequest> replan_{this, "replan", qos::event,
                                                  "A new plan is wanted, or none any more."};
  Output<std_msgs::msg::Header> forget_{this, "forget", qos::event, "What was seen of obstacles may be wrong."};
  Timer tick_{this, params_.period, &RecoveryComponent::on_tick};
  std::vector<kervan_msgs::msg::SonarReading> heard_;  ///< by each sonar at last
  std::string goal_;
  Time activated_{};

  void on_activate(Time now) override { activated_ = now; }
  void on_parameters_changed() override { recovery_.set_params(params_.recovery); }

  void on_status(const kervan_msgs::msg::GoalStatus& status, Time) {
    if (status.goal_id == goal_) return;
    goal_ = status.goal_id;
    recovery_.begin();
  }

  void on_command(const geometry_msgs::msg::TwistStamped& wanted, Time) {
    if (!recovery_.manoeuvre()) cmd_vel_.publish(wanted);
  }

  /// Sonars take turns: one whose turn it was not has NaN.
  void on_sonar(const kervan_msgs::msg::SonarArray& sonar, Time) {
    if (heard_.size() != sonar.readings.size()) heard_.assign(sonar.readings.begin(), sonar.readings.end());
    for (std::size_t i = 0; i < heard_.size(); ++i)
      if (!std::isnan(sonar.readings[i].range)) heard_[i] = sonar.readings[i];
  }

  Room room() const {
    RoomFinder finder(params_.recovery.hull);
    if (const auto* scan = scan_.latest(); scan && geometry::possible(geometry::scan_of(*scan))) {
      const geometry::Scan beams = geometry::scan_of(*scan);
      for (std::size_t i = 0; i < beams.ranges.size(); ++i) {
        const double yaw = beams.angle_min + static_cast<double>(i) * beams.angle_increment;
        const double range = static_cast<double>(beams.ranges[i]);
        if (std::isnan(range)) continue;
        const bool hit = range < beams.range_max;  // -inf: something too near to be measured
        finder.add(params_.mount * geometry::Pose2{0.0, 0.0, yaw}, hit ? std::max(range, 0.0) : beams.range_max, hit);
      }
    }
    if (const auto* sonar = sonar_.latest())
      for (const auto& reading : heard_) {
        if (std::isnan(reading.range)) continue;
        const bool hit = reading.range < sonar->max_range;
        finder.add({static_cast<double>(reading.x), static_cast<double>(reading.y), static_cast<double>(reading.yaw)},
                   static_cast<double>(hit ? std::max(reading.range, 0.0F) : sonar->max_range), hit);
      }
    return finder.room();
  }

  void on_tick(Time now) {
    for (const std::string& why : {wanted_.missing(), waypoint_.missing(), odom_.missing()})
      if (!why.empty()) return rest(now, why);
    const geometry::Pose2 robot = geometry::pose_of(odom_.latest()->pose.pose);
    const geometry::Vector2 waypoint = geometry::position_of(waypoint_.latest()->pose);
    const geometry::Twist2 command = geometry::twist_of(wanted_.latest()->twist);
    if (!robot.position().allFinite() || !std::isfinite(robot.yaw)) return rest(now, "odom: the pose is not finite");
    if (!waypoint.allFinite()) return rest(now, "waypoint: the position is not finite");
    std::optional<geometry::Vector2> target;
    if (!without_a_way()) target = waypoint;
    const Recovering recovering = recovery_.step(now, robot, target, command, room());
    if (recovering.begun) begin(*recovering.begun, recovering.why, now);
    if (recovering.twist) {
      auto message = cmd_vel_.loan();
      geometry::set_header(message->header, now, odom_.latest()->child_frame_id);
      message->twist = geometry::to_message(*recovering.twist);
      cmd_vel_.publish(std::move(message));
    }
    if (const auto rung = recovery_.manoeuvre())
      report_degraded("trapped: " + to_text(*rung));
    else
      report_active();
  }

  /// There is a goal, and no route to it.
  bool without_a_way() const {
    using kervan_msgs::msg::GoalState;
    const auto* route = route_.latest();
    const auto* status = status_.latest();
    return route && route->poses.empty() && status &&
           (status->state == GoalState::GOAL_PENDING || status->state == GoalState::GOAL_ACTIVE);
  }

  void begin(Rung rung, const std::string& why, Time now) {
    log().warn("{}: {}", why, to_text(rung));
    if (rung == Rung::forget) {
      auto header = forget_.loan();
      header->stamp = geometry::to_message(now);
      forget_.publish(std::move(header));
    }
    if (rung != Rung::replan && rung != Rung::give_up) return;
    auto request = replan_.loan();
    geometry::set_header(request->header, now, "");
    request->reason = "trapped: " + why;
    request->give_up = rung == Rung::give_up;
    replan_.publish(std::move(request));
  }

  /// Without knowing more the robot is left to its controller; a manoeuvre ends.
  void rest(Time now, std::string why) {
    recovery_.rest();
    // At the first tick nobody can have published yet.
    if (now - activated_ >= params_.period) report_degraded(std::move(why));
  }
};

}  // namespace
}  // namespace kervan::control

KERVAN_COMPONENT(kervan::control::RecoveryComponent, "control/recovery",
                 "Passes a controller's commands on, and frees the robot when it is trapped.")
