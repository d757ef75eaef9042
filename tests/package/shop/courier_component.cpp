#include <cmath>

#include "framework/kervan.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "shop_msgs/msg/Parcel.hpp"

namespace {

using namespace std::chrono_literals;
using nav_msgs::msg::Odometry;
using shop_msgs::msg::Parcel;

struct CourierParams {
  kervan::Duration period = 200ms;
  double mass = 1.0;
  std::string number = "P-1";
  template <class Visitor>
  void describe(Visitor& v) {
    v(period, "period", {.min = 0.01, .max = 10.0, .help = "Time between two reports."});
    v(mass, "mass", {.unit = "kg", .min = 0.0, .max = 20.0, .help = "Mass of the parcel."});
    v(number, "number", {.help = "The parcel's number."});
  }
};

/// Reports how far the parcel on a robot has been carried. Degraded while nobody says where the robot is.
class Courier final : public kervan::Component {
  const CourierParams& params_ = parameters<CourierParams>();
  kervan::Input<Odometry> odom_{this, "odom", kervan::qos::sensor, &Courier::on_odom, "Where the robot is."};
  kervan::Output<Parcel> parcel_{this, "parcel", kervan::qos::latched, "The parcel's way so far."};
  kervan::Timer tick_{this, params_.period, &Courier::on_tick};
  std::optional<kervan::geometry::Vector2> last_;
  double carried_ = 0.0;

  void on_odom(const Odometry& odom, kervan::Time) {
    const kervan::geometry::Vector2 here(odom.pose.pose.position.x, odom.pose.pose.position.y);
    if (last_) carried_ += (here - *last_).norm();
    last_ = here;
  }

  void on_tick(kervan::Time) {
    if (!last_) return report_degraded(odom_.missing());
    report_active();
    auto parcel = parcel_.loan();
    parcel->number = params_.number;
    parcel->header.frame_id = "base_link";
    parcel->mass = params_.mass;
    parcel->carried = carried_;
    parcel_.publish(std::move(parcel));
  }
};

}  // namespace

KERVAN_COMPONENT(Courier, "shop/courier", "Reports how far a robot has carried its parcel.")
