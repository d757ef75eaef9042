#include <spdlog/spdlog.h>

#include "components/localization/odometry_filter.hpp"
#include "components/localization/pose_ports.hpp"

namespace kervan::localization {
namespace {

using namespace std::chrono_literals;

struct OdometryComponentParams {
  OdometryFilterParams filter;
  geometry::Pose2 start;
  std::string frame = "map";
  bool odom_to_base = false;
  Duration period = 500ms;

  template <class Visitor>
  void describe(Visitor& v) {
    v(start, "start", {.min = -1e6, .max = 1e6, .help = "Pose of the odometry's frame in the map."});
    v(frame, "frame", {.help = "Name of the map's frame."});
    v(odom_to_base, "odom_to_base", {.help = "Says on /tf where base_link is in odom, too; false if the drive does."});
    v(filter.distance_error, "distance_error",
      {.min = 0.0, .max = 0.5, .help = "Standard deviation of the wheels' error per metre, constant for a run."});
    v(filter.turn_error, "turn_error",
      {.min = 0.0, .max = 0.5, .help = "Standard deviation of the wheels' error per radian, constant for a run."});
    v(filter.slip, "slip",
      {.min = 0.0, .max = 0.5, .help = "Standard deviation of the random error in m, and in rad, of the first metre."});
    v(period, "period",
      {.min = 0.01, .max = 60.0, .help = "Time between two looks at whether the odometry still comes."});
  }
};

/// Says where a robot is in the map by its wheels alone (odometry_filter.hpp).
class OdometryComponent final : public Component {
  const OdometryComponentParams& params_ = parameters<OdometryComponentParams>();
  OdometryFilter filter_{params_.filter, params_.start};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor.max_age(500ms), &OdometryComponent::on_odom,
                                       "Pose of base_link by its wheels."};
  PosePorts ports_{this};
  Timer tick_{this, params_.period, &OdometryComponent::on_tick};
  std::uint64_t refused_ = 0, anew_ = 0;
  std::string trouble_;  ///< since the last tick
  Time activated_{};

  void on_activate(Time now) override { activated_ = now; }

  void on_odom(const nav_msgs::msg::Odometry& odom, Time) {
    switch (filter_.odometry(geometry::time_of(odom.header.stamp), geometry::pose_of(odom.pose.pose))) {
      case OdometryResult::taken: break;
      case OdometryResult::began_anew:
        ++anew_;
        trouble_ = "odom: began anew; the robot is taken to have stood still";
        break;
      case OdometryResult::refused_pose:
        ++refused_;
        trouble_ = "odom: the pose is not finite";
        return;
      case OdometryResult::refused_stamp:
        ++refused_;
        trouble_ = "odom: a pose is not newer than the one before";
        return;
    }
    ports_.publish(odom, filter_, params_.frame, params_.odom_to_base);
  }

  void on_tick(Time now) {
    if (!trouble_.empty())
      report_degraded(trouble_);
    else if (odom_.missing().empty())
      report_active();
    else if (now - activated_ >= params_.period)  // At the first tick nobody can have published yet.
      report_degraded(odom_.missing());
    trouble_.clear();
  }

  void on_shutdown(Time) override {
    if (refused_ + anew_ > 0) log().warn("odometry: {} poses left out, began anew {} times", refused_, anew_);
  }
};

}  // namespace
}  // namespace kervan::localization

KERVAN_COMPONENT(kervan::localization::OdometryComponent, "localization/odometry",
                 "Says where a robot is in the map by its wheels alone.")
