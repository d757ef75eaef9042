#include "framework/kervan.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"

namespace {

using namespace std::chrono_literals;

/// Says in each message where that message lies.
class Talker final : public kervan::Component {
  kervan::Output<sensor_msgs::msg::LaserScan> out_{this, "talk", kervan::qos::event,
                                                   "Messages that tell their address."};
  kervan::Timer tick_{this, 10ms, &Talker::on_tick};

  void on_tick(kervan::Time) {
    auto message = out_.loan();
    message->header.frame_id = std::to_string(reinterpret_cast<std::uintptr_t>(&*message));
    message->ranges.resize(1000);
    out_.publish(std::move(message));
  }
};

}  // namespace

KERVAN_COMPONENT(Talker, "test/talker", "Publishes messages that tell their own address.")
