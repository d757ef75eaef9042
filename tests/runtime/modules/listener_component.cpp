#include "framework/kervan.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"

namespace {

/// Looks whether the messages it gets lie where they were made; tells after the hundredth.
class Listener final : public kervan::Component {
  kervan::Input<sensor_msgs::msg::LaserScan> in_{this, "talk", kervan::qos::event, &Listener::on_message, "Messages."};
  int heard_ = 0;
  int same_ = 0;

  void on_message(const sensor_msgs::msg::LaserScan& message, kervan::Time) {
    if (message.header.frame_id == std::to_string(reinterpret_cast<std::uintptr_t>(&message))) ++same_;
    if (++heard_ == 100) finish(std::to_string(same_) + " of " + std::to_string(heard_) + " are the same object");
  }
};

}  // namespace

KERVAN_COMPONENT(Listener, "test/listener", "Looks whether the messages it gets were copied.")
