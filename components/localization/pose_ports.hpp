/// The ports with which a component says where its robot is.
#pragma once

#include <string>
#include <utility>

#include "components/localization/odometry_filter.hpp"
#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "geometry_msgs/msg/TransformStamped.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "tf2_msgs/msg/TFMessage.hpp"

namespace kervan::localization {

class PosePorts {
 public:
  explicit PosePorts(Component* owner)
      : pose_(owner, "pose", qos::sensor, "Pose of base_link in map and its covariance, with the speed of odom."),
        tf_(owner, "/tf", qos::event, "map to odom, and odom to base_link if asked for.") {}

  /// Answers one odometry message, with its stamp and frames. `map`: name of the map's frame.
  void publish(const nav_msgs::msg::Odometry& odom, const OdometryFilter& filter, const std::string& map,
               bool odom_to_base) {
    auto pose = pose_.loan();
    pose->header.stamp = odom.header.stamp;
    pose->header.frame_id = map;
    pose->child_frame_id = odom.child_frame_id;
    pose->pose.pose = geometry::to_message(filter.pose());
    const Covariance covariance = filter.covariance();
    constexpr int of_six[] = {0, 1, 5};  // x, y, rotation about z
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        pose->pose.covariance[static_cast<std::size_t>(6 * of_six[i] + of_six[k])] = covariance(i, k);
    pose->twist = odom.twist;
    pose_.publish(std::move(pose));

    auto frames = tf_.loan();
    frames->transforms.push_back(transform(odom, map, odom.header.frame_id, filter.map_to_odom()));
    if (odom_to_base)
      frames->transforms.push_back(
          transform(odom, odom.header.frame_id, odom.child_frame_id, geometry::pose_of(odom.pose.pose)));
    tf_.publish(std::move(frames));
  }

 private:
  static geometry_msgs::msg::TransformStamped transform(const nav_msgs::msg::Odometry& odom, const std::string& parent,
                                                        const std::string& child, const geometry::Pose2& pose) {
    geometry_msgs::msg::TransformStamped message;
    message.header.stamp = odom.header.stamp;
    message.header.frame_id = parent;
    message.child_frame_id = child;
    message.transform.translation.x = pose.x;
    message.transform.translation.y = pose.y;
    message.transform.rotation = geometry::to_message(pose).orientation;
    return message;
  }

  Output<nav_msgs::msg::Odometry> pose_;
  Output<tf2_msgs::msg::TFMessage> tf_;
};

}  // namespace kervan::localization
