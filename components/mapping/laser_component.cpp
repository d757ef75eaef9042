#include <spdlog/spdlog.h>

#include <deque>
#include <string>
#include <vector>

#include "components/mapping/laser_mapper.hpp"
#include "components/mapping/map_maker.hpp"
#include "components/mapping/robot_mask.hpp"
#include "framework/geometry/messages.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"

namespace kervan::mapping {
namespace {

using sensor_msgs::msg::LaserScan;

struct LaserComponentParams {
  LaserMapperParams mapper;
  geometry::Pose2 mount;
  std::vector<std::string> others;
  double others_radius = 0.5;
  MapMakerParams map;

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
    v(others, "others", {.help = "Names of other robots, which are left out of the map."});
    v(others_radius, "others_radius",
      {.unit = "m", .min = 0.0, .max = 10.0, .help = "Beams that end so near to another robot are left out."});
    map.describe(v);
  }

  LaserMapperParams of_mapper() const {
    LaserMapperParams params = mapper;
    params.most_bytes = map.most_bytes();
    return params;
  }
};

/// Puts the scans of a laser into a map (laser_mapper.hpp), from where the odometry says that they were taken.
class LaserComponent final : public MapMaker<LaserComponentParams, LaserMapper, LaserScan> {
 public:
  LaserComponent() : MapMaker("scan", "scans", "What the laser measures.") {}

 private:
  std::deque<Input<nav_msgs::msg::Odometry>> others_ = others();
  std::vector<geometry::Vector2> robots_;  ///< where they are
  std::vector<float> ranges_;              ///< of the scan at hand, without them
  std::uint64_t added_ = 0, refused_scans_ = 0, refused_memory_ = 0;

  std::deque<Input<nav_msgs::msg::Odometry>> others() {
    std::deque<Input<nav_msgs::msg::Odometry>> others;
    for (const std::string& robot : params_.others)
      others.emplace_back(this, "/" + robot + "/odom", qos::sensor.max_age(params_.map.max_age).optional(),
                          "Where " + robot + " is, in the map.");
    return others;
  }

  void insert(const geometry::Pose2& pose, const LaserScan& message) override {
    const std::uint64_t refused = mapper_.refused_ranges();
    const geometry::Pose2 laser = pose * params_.mount;
    geometry::Scan scan = geometry::scan_of(message);
    robots_.clear();
    for (const auto& other : others_)
      if (const auto* odometry = other.latest()) robots_.push_back(geometry::position_of(odometry->pose.pose));
    if (!robots_.empty() && geometry::possible(scan)) {
      ranges_.assign(scan.ranges.begin(), scan.ranges.end());
      mask_robots(laser, scan, robots_, params_.others_radius, ranges_);
      scan.ranges = ranges_;
    }
    const ScanResult result = mapper_.add(laser, scan);
    if (mapper_.refused_ranges() != refused) complain("scan: ranges that are no distance are left out");
    switch (result) {
      case ScanResult::added: ++added_; return;
      case ScanResult::refused_scan: ++refused_scans_; return complain("scan: its angles or limits are none");
      case ScanResult::refused_place:
        ++refused_scans_;
        return complain("odom: the robot is too far away from the map's origin");
      case ScanResult::refused_memory:
        ++refused_memory_;
        return complain("the map may not grow any more, memory is used up: scans beyond it are left out");
    }
  }

  void on_shutdown(Time) override {
    log().info("{} scans in the map of {} x {} cells, {} tiles published", added_, mapper_.box().columns,
               mapper_.box().rows, ports_.published());
    if (mapper_.refused_ranges() + refused_scans_ + refused_memory_ + dropped() > 0)
      log().warn("left out: {} ranges, {} scans, {} for want of memory, {} late or without a pose",
                 mapper_.refused_ranges(), refused_scans_, refused_memory_, dropped());
  }
};

}  // namespace
}  // namespace kervan::mapping

KERVAN_COMPONENT(kervan::mapping::LaserComponent, "mapping/laser", "Makes a map out of a laser's scans.")
