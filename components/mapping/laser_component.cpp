#include <spdlog/spdlog.h>

#include "components/mapping/laser_mapper.hpp"
#include "components/mapping/map_maker.hpp"
#include "framework/geometry/messages.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"

namespace kervan::mapping {
namespace {

using sensor_msgs::msg::LaserScan;

struct LaserComponentParams {
  LaserMapperParams mapper;
  geometry::Pose2 mount;
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
  std::uint64_t added_ = 0, refused_scans_ = 0, refused_memory_ = 0;

  void insert(const geometry::Pose2& pose, const LaserScan& scan) override {
    const std::uint64_t refused = mapper_.refused_ranges();
    const ScanResult result = mapper_.add(pose * params_.mount, geometry::scan_of(scan));
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
