#ifdef KERVAN_BENCH_MRPT
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationRange.h>
#endif

#include <numbers>

#include "tests/bench/mapping_reference.hpp"

namespace kervan::bench {

#ifdef KERVAN_BENCH_MRPT

namespace {

class MrptMap final : public ReferenceMap {
 public:
  explicit MrptMap(double resolution) : map_(-20.0f, 20.0f, -20.0f, 20.0f, static_cast<float>(resolution)) {
    map_.insertionOptions.maxDistanceInsertion = 15.0f;
    map_.insertionOptions.wideningBeamsWithDistance = false;
    range_.minSensorDistance = 0.15f;
    range_.maxSensorDistance = 5.0f;
    range_.sensedData.resize(1);
    scan_.aperture = static_cast<float>(std::numbers::pi);
    scan_.rightToLeft = true;
    scan_.maxRange = 15.0f;
  }

  std::string name() const override { return "MRPT"; }

  void sonar(const geometry::Pose2& at, double range, double aperture) override {
    range_.sensorConeApperture = static_cast<float>(aperture);
    range_.sensedData[0].sensedDistance = static_cast<float>(range);
    map_.insertObservation(range_, mrpt::poses::CPose3D(at.x, at.y, 0.0, at.yaw, 0.0, 0.0));
  }

  void laser(const geometry::Pose2& at, const std::vector<float>& ranges) override {
    if (scan_.getScanSize() != ranges.size()) scan_.resizeScan(ranges.size());
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      scan_.setScanRange(i, ranges[i]);
      scan_.setScanRangeValidity(i, true);
    }
    map_.insertObservation(scan_, mrpt::poses::CPose3D(at.x, at.y, 0.0, at.yaw, 0.0, 0.0));
  }

 private:
  mrpt::maps::COccupancyGridMap2D map_;
  mrpt::obs::CObservationRange range_;
  mrpt::obs::CObservation2DRangeScan scan_;
};

}  // namespace

std::unique_ptr<ReferenceMap> mrpt_map(double resolution) { return std::make_unique<MrptMap>(resolution); }

#else

std::unique_ptr<ReferenceMap> mrpt_map(double) { return nullptr; }

#endif

}  // namespace kervan::bench
