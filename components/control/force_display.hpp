/// Shows the forces that steer a robot, for looking at.
#pragma once

#include <string>
#include <utility>

#include "framework/geometry/messages.hpp"
#include "framework/kervan.hpp"
#include "kervan_msgs/msg/ForceField.hpp"

namespace kervan::control {

/// A member of a component that has forces to show.
class ForceDisplay {
 public:
  explicit ForceDisplay(Component* owner)
      : force_(owner, "force", qos::sensor, "The forces on the robot, for looking at.") {}

  /// On a robot at `robot`, m in `frame`; the forces have no unit.
  void show(Time now, const std::string& frame, const geometry::Vector2& robot, const geometry::Vector2& attraction,
            const geometry::Vector2& repulsion) {
    auto message = force_.loan();
    geometry::set_header(message->header, now, frame);
    message->position.x = robot.x();
    message->position.y = robot.y();
    message->attraction.x = attraction.x();
    message->attraction.y = attraction.y();
    message->repulsion.x = repulsion.x();
    message->repulsion.y = repulsion.y();
    force_.publish(std::move(message));
  }

 private:
  Output<kervan_msgs::msg::ForceField> force_;
};

}  // namespace kervan::control
