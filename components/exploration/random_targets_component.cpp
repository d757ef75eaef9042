#include <spdlog/spdlog.h>

#include <cmath>
#include <string>
#include <vector>

#include "components/exploration/target_tour.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/Contact.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "kervan_msgs/msg/Outline.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "nav_msgs/msg/Path.hpp"

namespace kervan::exploration {
namespace {

using namespace std::chrono_literals;
using geometry::Vector2;
using kervan_msgs::msg::GoalState;

struct RandomTargetsParams {
  TargetTourParams tour;
  std::int64_t seed = 1;
  std::vector<Vector2> area;
  Duration period = 50ms;

  template <class Visitor>
  void describe(Visitor& v) {
    v(seed, "seed",
      {.min = 0, .max = 4294967295, .help = "Of the targets, and of the turns of a robot that was stuck."});
    v(area, "area",
      {.unit = "m",
       .min = -1e6,
       .max = 1e6,
       .help = "Two opposite corners of where targets lie; none: all of the world."});
    v(tour.room, "room",
      {.unit = "m", .min = 0.0, .max = 10.0, .help = "From a target to the nearest obstacle at least."});
    v(tour.arrive_within, "arrive_within",
      {.unit = "m", .min = 0.01, .max = 10.0, .help = "A target is reached by a robot this near to it."});
    v(tour.patience, "patience",
      {.min = 1.0, .max = 3600.0, .help = "A target not reached by then is replaced by the next."});
    v(tour.visits.spacing, "spacing", {.unit = "m", .min = 0.1, .max = 100.0, .help = "Of the points along a route."});
    v(tour.visits.within, "visit_within",
      {.unit = "m", .min = 0.01, .max = 10.0, .help = "A point is visited by a robot this near to it."});
    v(tour.stuck.distance, "stuck_distance",
      {.unit = "m", .min = 0.01, .max = 10.0, .help = "A robot is stuck that does not get so far away from a place …"});
    v(tour.stuck.time, "stuck_time", {.min = 0.1, .max = 600.0, .help = "… while it is told to move for so long."});
    v(tour.back_off.distance, "back_distance",
      {.unit = "m", .min = 0.01, .max = 10.0, .help = "A stuck robot backs so far."});
    v(tour.back_off.speed, "back_speed", {.unit = "m/s", .min = 0.01, .max = 2.0, .help = "So fast it backs."});
    v(tour.back_off.turn_rate, "turn_rate",
      {.unit = "rad/s", .min = 0.01, .max = 10.0, .help = "So fast it turns after that."});
    v(tour.least_turn, "least_turn",
      {.unit = "rad", .min = 0.0, .max = 3.1415926, .help = "It turns to either side, from this to half a turn."});
    v(period, "period", {.min = 0.01, .max = 0.2, .help = "Time between two looks at the robot."});
  }

  TargetTourParams of_tour() const {
    TargetTourParams params = tour;
    params.seed = static_cast<std::uint64_t>(seed);
    if (area.size() == 2) params.area = Area{area[0].cwiseMin(area[1]), area[0].cwiseMax(area[1])};
    return params;
  }
};

Obstacles obstacles_of(const kervan_msgs::msg::Outline& outline) {
  Obstacles obstacles;
  for (const auto& s : outline.segments) obstacles.walls.push_back({{s.x1, s.y1}, {s.x2, s.y2}});
  for (const auto& c : outline.circles) obstacles.circles.push_back({{c.x, c.y}, c.radius});
  for (const auto& polygon : outline.polygons) {
    auto& corners = obstacles.polygons.emplace_back();
    for (const auto& corner : polygon.corners) corners.emplace_back(corner.x, corner.y);
  }
  return obstacles;
}

/// Sends a robot from one random target to the next, counts how it does, and gets it free when it is stuck
/// (target_tour.hpp). Stands between the controller and the drive.
class RandomTargets final : public Component {
  const RandomTargetsParams& params_ = checked(parameters<RandomTargetsParams>());
  TargetTour tour_{params_.of_tour()};
  Input<nav_msgs::msg::Odometry> truth_{this, "truth", qos::state, "Where the robot is, to be judged by."};
  Input<nav_msgs::msg::Path> route_{this, "route", qos::latched, &RandomTargets::on_route, "What is planned."};
  Input<kervan_msgs::msg::GoalStatus> status_{this, "goal_status", qos::latched.optional(), &RandomTargets::on_status,
                                              "What has become of the target."};
  Input<geometry_msgs::msg::TwistStamped> wanted_{this, "cmd_vel_wanted", qos::command.max_age(500ms),
                                                  &RandomTargets::on_command, "Speed that the controller wants."};
  Input<kervan_msgs::msg::Outline> world_{this, "world", qos::latched.optional(), &RandomTargets::on_world,
                                          "What targets keep away from; without it they lie anywhere in the area."};
  Input<kervan_msgs::msg::Contact> contact_{this, "contact", qos::event.optional(), "Every touch of the robot."};
  Output<geometry_msgs::msg::PoseStamped> goal_{this, "goal", qos::latched, "The present target."};
  Output<geometry_msgs::msg::TwistStamped> cmd_vel_{this, "cmd_vel_raw", qos::command,
                                                    "The controller's command, or what gets a stuck robot free."};
  Timer tick_{this, params_.period, &RandomTargets::on_tick};
  std::string goal_id_;
  std::uint64_t contacts_ = 0;
  Time activated_{};

  static const RandomTargetsParams& checked(const RandomTargetsParams& params) {
    const auto& area = params.area;
    if (!area.empty() && (area.size() != 2 || area[0].x() == area[1].x() || area[0].y() == area[1].y()))
      throw ParameterError("area", "it needs two opposite corners of a rectangle, such as [[0 m, 0 m], [20 m, 15 m]]");
    return params;
  }

  void on_activate(Time now) override { activated_ = now; }

  void on_world(const kervan_msgs::msg::Outline& outline, Time) { tour_.surround(obstacles_of(outline)); }

  void on_route(const nav_msgs::msg::Path& route, Time) {
    std::vector<Vector2> points;
    for (const auto& pose : route.poses) points.push_back(geometry::position_of(pose.pose));
    tour_.route(points);
  }

  void on_status(const kervan_msgs::msg::GoalStatus& status, Time) {
    if (status.goal_id != goal_id_ || status.state != GoalState::GOAL_FAILED) return;
    log().info("target {} is given up: {}", tour_.figures().targets, status.reason);
    tour_.give_up();
  }

  void on_command(const geometry_msgs::msg::TwistStamped& wanted, Time) {
    if (!tour_.manoeuvre()) cmd_vel_.publish(wanted);
  }

  void on_tick(Time now) {
    contacts_ += contact_.take().size();
    const auto* truth = truth_.latest();
    const geometry::Pose2 pose = truth ? geometry::pose_of(truth->pose.pose) : geometry::Pose2{};
    if (!truth || !pose.position().allFinite() || !std::isfinite(pose.yaw)) {
      // At the first tick nobody can have published yet.
      if (now - activated_ >= params_.period)
        report_degraded(truth ? "truth: the pose is not finite" : truth_.missing());
      return;
    }
    const auto* wanted = wanted_.latest();
    const bool commanded = wanted && !(geometry::twist_of(wanted->twist) == geometry::Twist2{});
    switch (tour_.step(now, pose, commanded)) {
      case TargetTour::Event::none: break;
      case TargetTour::Event::new_target: publish_goal(now, truth->header.frame_id); break;
      case TargetTour::Event::stuck: log().info("stuck at ({:.2f}, {:.2f})", pose.x, pose.y); break;
      case TargetTour::Event::no_target:
        return report_degraded(params_.area.empty() && !world_.latest() ? world_.missing()
                                                                        : "no place with enough room for a target");
    }
    report_active();
    if (tour_.manoeuvre()) command(now, truth->child_frame_id, *tour_.manoeuvre());
  }

  void publish_goal(Time now, const std::string& frame) {
    auto goal = goal_.loan();
    geometry::set_header(goal->header, now, frame);
    goal->pose = geometry::to_message(geometry::Pose2{tour_.target()->x(), tour_.target()->y(), 0.0});
    goal_id_ = geometry::goal_id_of(goal->header.stamp);
    goal_.publish(std::move(goal));
  }

  void command(Time now, const std::string& frame, const geometry::Twist2& twist) {
    auto message = cmd_vel_.loan();
    geometry::set_header(message->header, now, frame);
    message->twist = geometry::to_message(twist);
    cmd_vel_.publish(std::move(message));
  }

  void on_deactivate(Time now) override { command(now, {}, {}); }

  void on_shutdown(Time) override {
    contacts_ += contact_.take().size();
    const TourFigures& figures = tour_.figures();
    const auto count = [](std::uint64_t number) { return static_cast<std::int64_t>(number); };
    write_figures({{"points", count(figures.points)},
                   {"stuck", count(figures.stuck)},
                   {"targets", count(figures.targets)},
                   {"reached", count(figures.reached)},
                   {"unreachable", count(figures.unreachable)},
                   {"late", count(figures.late)},
                   {"contacts", count(contacts_)},
                   {"path_m", figures.path},
                   {"first_reached_s", figures.first_reached ? Value(seconds(*figures.first_reached)) : Value()}});
  }
};

}  // namespace
}  // namespace kervan::exploration

KERVAN_COMPONENT(kervan::exploration::RandomTargets, "exploration/random_targets",
                 "Sends a robot to random targets, counts how it does, and gets it free when it is stuck.")
