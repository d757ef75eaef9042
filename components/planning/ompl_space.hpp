/// The state spaces that OMPL's planners plan in, on a costmap.
#pragma once

#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSpace.h>

#include <memory>
#include <vector>

#include "components/planning/costmap.hpp"
#include "components/planning/ompl_budget.hpp"
#include "components/planning/ompl_planner.hpp"

namespace kervan::planning {

/// Poses of a robot and how it gets from one to another. Lengths are in cells, as Costmap::to_cells.
class OmplMotions {
 public:
  virtual ~OmplMotions() = default;

  virtual ompl::base::StateSpacePtr space() = 0;
  virtual geometry::Pose2 pose_of(const ompl::base::State* state) const = 0;
  virtual void place(ompl::base::State* state, const geometry::Pose2& pose) const = 0;

  /// The motion from one state to another as straight lines: where each of them ends is added to `corners`. Arcs are
  /// cut into lines short enough to leave them by less than a hundredth of their radius; the route consists of these
  /// lines, too. False if there is no such motion.
  virtual bool trace(const ompl::base::State* from, const ompl::base::State* to,
                     std::vector<geometry::Pose2>& corners) const = 0;
};

/// Distances are counted in `budget`, which must live as long. `radius`: of the tightest turn, cells.
std::shared_ptr<OmplMotions> make_motions(OmplSpace kind, const Costmap& map, double radius, OmplBudget& budget);

/// True if no line of the motion touches a blocked cell, not even with a corner. `corners` is used and left as it is.
bool motion_is_free(const Costmap& map, const geometry::Pose2& from, const std::vector<geometry::Pose2>& corners,
                    OmplBudget& budget);

/// States are valid in free cells, motions as motion_is_free() says: OMPL's own test looks at points of a motion, and
/// misses thin walls.
ompl::base::SpaceInformationPtr make_space_information(const std::shared_ptr<OmplMotions>& motions, const Costmap& map,
                                                       OmplBudget& budget);

}  // namespace kervan::planning
