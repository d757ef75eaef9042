/// Maps by the textbook and by MRPT, to compare ours with.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "components/grid/cells.hpp"
#include "components/mapping/sonar_model.hpp"

namespace kervan::bench {

/// Another way to make a map, 40 x 40 m around the origin.
class ReferenceMap {
 public:
  virtual ~ReferenceMap() = default;
  virtual std::string name() const = 0;
  virtual void sonar(const geometry::Pose2& transducer, double range, double aperture) = 0;
  /// Beams over half a circle.
  virtual void laser(const geometry::Pose2& laser, const std::vector<float>& ranges) = 0;
};

/// Floats, every cell of the full circle's bounding box, atan2 and Bayes' rule with a division; a beam walks from cell
/// to cell.
std::unique_ptr<ReferenceMap> textbook_map(double resolution, const mapping::SonarModelParams& model);

/// MRPT's occupancy grid; nullptr if the benchmark was built without it.
std::unique_ptr<ReferenceMap> mrpt_map(double resolution);

}  // namespace kervan::bench
