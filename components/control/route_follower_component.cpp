#include <spdlog/spdlog.h>

#include <vector>

#include "components/control/route_follower.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/PoseStamped.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "nav_msgs/msg/Path.hpp"

namespace kervan::control {
namespace {

using namespace std::chrono_literals;

struct RouteFollowerComponentParams {
  RouteFollowerParams follow;

  template <class Visitor>
  void describe(Visitor& v) {
    v(follow.pass_within, "pass_within",
      {.unit = "m",
       .min = 0.0,
       .max = 10.0,
       .help = "An intermediate waypoint counts as passed within this distance.",
       .live = true});
    v(follow.arrive_within, "arrive_within",
      {.unit = "m",
       .min = 0.0,
       .max = 10.0,
       .help = "The last waypoint counts as reached within this distance.",
       .live = true});
    v(follow.look_ahead, "look_ahead",
      {.unit = "m",
       .min = 0.0,
       .max = 10.0,
       .help = "How far ahead on the route the waypoint lies, from where the robot passes; 0: it is the next one.",
       .live = true});
    v(follow.cut_corners, "cut_corners",
      {.unit = "m",
       .min = 0.0,
       .max = 10.0,
       .help = "With a look-ahead, how far the straight way to the waypoint may leave the route.",
       .live = true});
  }
};

/// Hands out the waypoint to drive to now. An empty route asks the robot to stay where it is.
class RouteFollowerComponent final : public Component {
  const RouteFollowerComponentParams& params_ = parameters<RouteFollowerComponentParams>();
  RouteFollower follower_{params_.follow};
  Input<nav_msgs::msg::Path> route_{this, "route", qos::latched, &RouteFollowerComponent::on_route,
                                    "Waypoints to drive through, in order."};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor.max_age(500ms), &RouteFollowerComponent::on_odometry,
                                       "Where the robot is."};
  Output<geometry_msgs::msg::PoseStamped> waypoint_{this, "waypoint", qos::latched, "Where to drive now."};
  std::string frame_;
  bool joined_ = true;  ///< the route, at the place where the robot is

  void on_parameters_changed() override { follower_.set_params(params_.follow); }

  void on_route(const nav_msgs::msg::Path& route, Time now) {
    std::vector<geometry::Vector2> points;
    for (const auto& pose : route.poses) points.push_back(geometry::position_of(pose.pose));
    frame_ = route.header.frame_id;
    const auto* odometry = odom_.latest();
    if (points.empty() && odometry) points.push_back(geometry::position_of(odometry->pose.pose));
    follower_.start(std::move(points));
    joined_ = false;
    if (odometry) join(*odometry, now);
  }

  /// A component that was started again gets its route again, on which the robot has driven a part already.
  void join(const nav_msgs::msg::Odometry& odometry, Time now) {
    const geometry::Vector2 position = geometry::position_of(odometry.pose.pose);
    follower_.join(position);
    follower_.advance(position);
    joined_ = true;
    publish_waypoint(now);
  }

  void on_odometry(const nav_msgs::msg::Odometry& odometry, Time now) {
    if (!joined_) return join(odometry, now);
    const std::size_t before = follower_.index();
    const auto waypoint = follower_.waypoint();
    const bool arrived = follower_.arrived();
    follower_.advance(geometry::position_of(odometry.pose.pose));
    if (follower_.index() != before) log().info("waypoint {} of {} passed", follower_.index(), follower_.size());
    if (follower_.waypoint() != waypoint) publish_waypoint(now);
    if (follower_.arrived() && !arrived) log().info("arrived at the last waypoint, by odometry");
  }

  void publish_waypoint(Time now) {
    const auto at = follower_.waypoint();
    if (!at) return;
    auto waypoint = waypoint_.loan();
    geometry::set_header(waypoint->header, now, frame_);
    waypoint->pose = geometry::to_message(geometry::Pose2{at->x(), at->y(), 0.0});
    waypoint_.publish(std::move(waypoint));
  }
};

}  // namespace
}  // namespace kervan::control

KERVAN_COMPONENT(kervan::control::RouteFollowerComponent, "control/route_follower",
                 "Hands out the waypoints of a route one after the other.")
