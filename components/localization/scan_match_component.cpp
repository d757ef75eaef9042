#include <spdlog/spdlog.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "components/localization/pose_ports.hpp"
#include "components/localization/scan_match_params.hpp"
#include "components/mapping/posed_readings.hpp"
#include "framework/geometry/messages.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"

namespace kervan::localization {
namespace {

using namespace std::chrono_literals;
using kervan_msgs::msg::SonarArray;
using sensor_msgs::msg::LaserScan;

/// Says where a robot is in the map that it makes, by its wheels and by its laser or its sonars (laser_localizer.hpp,
/// sonar_localizer.hpp).
class ScanMatchComponent final : public Component {
  const ScanMatchParams& params_ = parameters<ScanMatchParams>();
  std::optional<LaserLocalizer> by_laser_;
  std::optional<SonarLocalizer> by_sonar_;
  mapping::PosedReadings<Sample<LaserScan>> scans_{params_.max_age};
  mapping::PosedReadings<Sample<SonarArray>> rounds_{params_.max_age};
  // Before the odometry: of what arrives together the reading comes first, so that the pose published is corrected.
  std::optional<Input<LaserScan>> scan_;
  std::optional<Input<SonarArray>> sonar_;
  std::optional<Input<nav_msgs::msg::Odometry>> odom_;
  PosePorts ports_{this};
  Timer tick_{this, params_.period, &ScanMatchComponent::on_tick};
  Time activated_{};
  std::vector<SonarEcho> echoes_;
  Outcome outcome_ = Outcome::waiting;  ///< of the last comparison
  std::array<std::uint64_t, outcomes> count_{};
  std::uint64_t refused_odometry_ = 0;
  std::uint64_t dropped_ = 0, refused_ranges_ = 0, refused_memory_ = 0;  ///< up to the last tick
  std::string trouble_;                                                  ///< since the last tick

 public:
  ScanMatchComponent() {
    if (params_.sensor == MatchSensor::laser) {
      by_laser_.emplace(params_.of_laser());
      scan_.emplace(this, "scan", qos::sensor, &ScanMatchComponent::on_scan, "What the laser measures.");
    } else {
      by_sonar_.emplace(params_.of_sonar());
      sonar_.emplace(this, "sonar", qos::sensor, &ScanMatchComponent::on_sonar, "What the sonars measure.");
    }
    odom_.emplace(this, "odom", qos::sensor.max_age(500ms), &ScanMatchComponent::on_odom,
                  "Pose of base_link by its wheels.");
  }

 private:
  OdometryFilter& filter() { return by_laser_ ? by_laser_->filter() : by_sonar_->filter(); }

  void on_activate(Time now) override { activated_ = now; }

  void on_odom(const nav_msgs::msg::Odometry& odom, Time now) {
    const Time stamp = geometry::time_of(odom.header.stamp);
    const geometry::Pose2 pose = geometry::pose_of(odom.pose.pose);
    switch (filter().odometry(stamp, pose)) {
      case OdometryResult::taken: break;
      case OdometryResult::began_anew:
        trouble_ = "odom: began anew; the robot is taken to have stood still";
        ++refused_odometry_;
        break;
      case OdometryResult::refused_pose:
        ++refused_odometry_;
        trouble_ = "odom: the pose is not finite";
        return;
      case OdometryResult::refused_stamp:
        ++refused_odometry_;
        trouble_ = "odom: a pose is not newer than the one before";
        return;
    }
    scans_.pose(stamp, pose);
    rounds_.pose(stamp, pose);
    place(now);
    ports_.publish(odom, filter(), params_.frame, params_.odom_to_base);
  }

  void on_scan(const Sample<LaserScan>& scan, Time now) {
    if (scan.disposed()) return;
    scans_.reading(geometry::time_of(scan->header.stamp), now, scan);
    place(now);
  }

  void on_sonar(const Sample<SonarArray>& sonar, Time now) {
    if (sonar.disposed()) return;
    rounds_.reading(geometry::time_of(sonar->header.stamp), now, sonar);
    place(now);
  }

  void place(Time now) {
    scans_.release(now, [this](const geometry::Pose2& odom, const Sample<LaserScan>& scan, Time) {
      count(by_laser_->scan(odom, geometry::scan_of(*scan)));
    });
    rounds_.release(now, [this](const geometry::Pose2& odom, const Sample<SonarArray>& array, Time) {
      echoes_.clear();
      for (const auto& reading : array->readings)
        echoes_.push_back(
            {{static_cast<double>(reading.x), static_cast<double>(reading.y), static_cast<double>(reading.yaw)},
             static_cast<double>(reading.range)});
      const bool fits = std::abs(static_cast<double>(array->field_of_view) - 2.0 * params_.half_aperture) < 0.01;
      count(fits ? by_sonar_->round(odom, echoes_,
                                    {static_cast<double>(array->min_range), static_cast<double>(array->max_range)})
                 : Outcome::refused_scan);
    });
  }

  void count(Outcome outcome) {
    ++count_[static_cast<std::size_t>(outcome)];
    if (outcome == Outcome::refused_scan)
      trouble_ = input_name() + ": not of this robot, or nothing that could be: left out";
    else if (outcome == Outcome::refused_place)
      trouble_ = "odom: the robot is too far away from the map's origin";
    else if (outcome != Outcome::waiting)
      outcome_ = outcome;
  }

  std::string input_name() const { return scan_ ? scan_->name() : sonar_->name(); }
  std::string missing() const {
    if (std::string why = odom_->missing(); !why.empty()) return why;
    return scan_ ? scan_->missing() : sonar_->missing();
  }

  void on_tick(Time now) {
    place(now);
    const auto dropped = scans_.late() + scans_.unplaced() + rounds_.late() + rounds_.unplaced();
    if (dropped != dropped_ && trouble_.empty())
      trouble_ = input_name() + ": readings too old, or without a pose of their time, are left out";
    dropped_ = dropped;
    const auto ranges = by_laser_ ? by_laser_->refused_ranges() : by_sonar_->refused_ranges();
    if (ranges != refused_ranges_ && trouble_.empty())
      trouble_ = input_name() + ": ranges that are no distance are left out";
    refused_ranges_ = ranges;

    const auto beyond = by_laser_ ? by_laser_->refused_memory() : by_sonar_->refused_memory();
    if (beyond != refused_memory_ && trouble_.empty())
      trouble_ = "the map may not grow any more, memory is used up: echoes beyond it are left out";
    refused_memory_ = beyond;

    const char* const poor = localization::reason(outcome_);
    if (!trouble_.empty())
      report_degraded(trouble_);
    else if (const std::string why = missing(); !why.empty()) {
      if (now - activated_ >= params_.period) report_degraded(why);  // At the first tick nobody can have published yet.
    } else if (*poor != '\0')
      report_degraded(poor);
    else
      report_active();
    trouble_.clear();
  }

  std::uint64_t counted(Outcome outcome) const { return count_[static_cast<std::size_t>(outcome)]; }

  void on_shutdown(Time) override {
    log().info("{} matches, {} along a line, {} where the map says too little, {} poor, {} ambiguous",
               counted(Outcome::matched), counted(Outcome::line), counted(Outcome::unknown), counted(Outcome::poor),
               counted(Outcome::ambiguous));
    const auto refused = counted(Outcome::refused_scan) + counted(Outcome::refused_place);
    if (refused + refused_ranges_ + refused_memory_ + dropped_ + refused_odometry_ > 0)
      log().warn(
          "left out: {} readings that do not fit, {} ranges, {} echoes for want of memory, {} late or without a "
          "pose, {} poses",
          refused, refused_ranges_, refused_memory_, dropped_, refused_odometry_);
  }
};

}  // namespace
}  // namespace kervan::localization

KERVAN_COMPONENT(kervan::localization::ScanMatchComponent, "localization/scan_match",
                 "Says where a robot is in the map that it makes, by its wheels and its laser or sonars.")
