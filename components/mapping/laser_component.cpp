#include <spdlog/spdlog.h>

#include "components/mapping/laser_mapper.hpp"
#include "components/mapping/map_ports.hpp"
#include "components/mapping/posed_readings.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"

namespace kervan::mapping {
namespace {

using namespace std::chrono_literals;
using sensor_msgs::msg::LaserScan;

struct LaserComponentParams {
  LaserMapperParams mapper;
  geometry::Pose2 mount;
  double memory = 128.0;
  geometry::Pose2 start;
  std::string frame = "map";
  Duration max_age = 500ms;
  Duration period = 500ms;

  template <class Visitor>
  void describe(Visitor& v) {
    v(mapper.resolution, "resolution", {.unit = "m", .min = 0.01, .max = 1.0, .help = "Side of a cell."});
    v(mapper.hit, "hit",
      {.min = 0.5, .max = 0.99, .help = "P(occupied) of a cell that a beam ends in, given one scan."});
    v(mapper.miss, "miss", {.min = 0.01, .max = 0.5, .help = "P(occupied) of a cell that beams pass through."});
    v(mapper.max_range, "max_range",
      {.unit = "m", .min = 0.1, .max = 200.0, .help = "Beams that end farther away are used up to here."});
    v(mapper.no_echo_limit, "no_echo_limit",
      {.unit = "m", .min = 0.0, .max = 200.0, .help = "How far a beam that brings nothing back clears its way."});
    v(mount, "mount", {.min = -10.0, .max = 10.0, .help = "Pose of the laser in base_link."});
    v(memory, "memory", {.unit = "", .min = 0.1, .max = 16384.0, .help = "That the map may take, in MiB."});
    v(start, "start", {.min = -1e6, .max = 1e6, .help = "Pose of the odometry's frame in the map."});
    v(frame, "frame", {.help = "Name of the map's frame."});
    v(max_age, "max_age", {.min = 0.001, .max = 60.0, .help = "Older scans are left out."});
    v(period, "period", {.min = 0.01, .max = 60.0, .help = "Time between two looks at what has changed."});
  }

  LaserMapperParams of_mapper() const {
    LaserMapperParams params = mapper;
    params.most_bytes = static_cast<std::size_t>(memory * 1024.0 * 1024.0);
    return params;
  }
};

/// Puts the scans of a laser into a map (laser_mapper.hpp), from where the odometry says that they were taken.
class LaserComponent final : public Component {
  const LaserComponentParams& params_ = parameters<LaserComponentParams>();
  LaserMapper mapper_{params_.of_mapper()};
  PosedReadings<Sample<LaserScan>> scans_{params_.max_age};
  Input<nav_msgs::msg::Odometry> odom_{this, "odom", qos::sensor, &LaserComponent::on_odom, "Pose of base_link."};
  Input<LaserScan> scan_{this, "scan", qos::sensor, &LaserComponent::on_scan, "What the laser measures."};
  MapPorts ports_{this};
  Timer tick_{this, params_.period, &LaserComponent::on_tick};
  Time activated_{};
  std::uint64_t added_ = 0, refused_scans_ = 0, refused_memory_ = 0, dropped_ = 0;
  std::uint64_t refused_ranges_ = 0;  ///< up to the last tick
  std::string trouble_;               ///< since the last tick

  void on_activate(Time now) override {
    activated_ = now;
    ports_.begin(now);
  }

  void on_odom(const nav_msgs::msg::Odometry& odom, Time now) {
    scans_.pose(geometry::time_of(odom.header.stamp), params_.start * geometry::pose_of(odom.pose.pose));
    place(now);
  }

  void on_scan(const Sample<LaserScan>& scan, Time now) {
    if (scan.disposed()) return;
    scans_.reading(geometry::time_of(scan->header.stamp), now, scan);
    place(now);
  }

  void place(Time now) {
    scans_.release(now, [this](const geometry::Pose2& pose, const Sample<LaserScan>& scan, Time) {
      count(mapper_.add(pose * params_.mount,
                        {static_cast<double>(scan->angle_min), static_cast<double>(scan->angle_increment),
                         static_cast<double>(scan->range_min), static_cast<double>(scan->range_max), scan->ranges}));
    });
  }

  void count(ScanResult result) {
    switch (result) {
      case ScanResult::added: ++added_; return;
      case ScanResult::refused_scan:
        ++refused_scans_;
        trouble_ = "scan: its angles or limits are none";
        return;
      case ScanResult::refused_place:
        ++refused_scans_;
        trouble_ = "odom: the robot is too far away from the map's origin";
        return;
      case ScanResult::refused_memory:
        ++refused_memory_;
        trouble_ = "the map may not grow any more, memory is used up: scans beyond it are left out";
        return;
    }
  }

  void on_tick(Time now) {
    place(now);
    const auto dropped = scans_.late() + scans_.unplaced() + scans_.bad_poses();
    if (dropped != dropped_ && trouble_.empty()) trouble_ = "scan: scans without a pose of their time are left out";
    if (mapper_.refused_ranges() != refused_ranges_ && trouble_.empty())
      trouble_ = "scan: ranges that are no distance are left out";
    dropped_ = dropped;
    refused_ranges_ = mapper_.refused_ranges();
    ports_.publish(mapper_, now, params_.frame);
    if (!trouble_.empty())
      report_degraded(trouble_);
    else if (const std::string missing = !odom_.missing().empty() ? odom_.missing() : scan_.missing(); missing.empty())
      report_active();
    else if (now - activated_ >= params_.period)  // At the first tick nobody can have published yet.
      report_degraded(missing);
    trouble_.clear();
  }

  void on_deactivate(Time now) override { ports_.publish(mapper_, now, params_.frame); }

  void on_shutdown(Time) override {
    log().info("{} scans in the map of {} x {} cells, {} tiles published", added_, mapper_.box().columns,
               mapper_.box().rows, ports_.published());
    if (mapper_.refused_ranges() + refused_scans_ + refused_memory_ + dropped_ > 0)
      log().warn("left out: {} ranges, {} scans, {} for want of memory, {} late or without a pose",
                 mapper_.refused_ranges(), refused_scans_, refused_memory_, dropped_);
  }
};

}  // namespace
}  // namespace kervan::mapping

KERVAN_COMPONENT(kervan::mapping::LaserComponent, "mapping/laser", "Makes a map out of a laser's scans.")
