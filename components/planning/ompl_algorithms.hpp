/// OMPL's planners, made by their names.
#pragma once

#include <ompl/base/Planner.h>

#include "components/planning/ompl_planner.hpp"

namespace kervan::planning {

ompl::base::PlannerPtr make_ompl(OmplAlgorithm algorithm, const ompl::base::SpaceInformationPtr& information);

/// It goes on making a way shorter until it is told to stop; else it ends with the first one.
bool optimizes(OmplAlgorithm algorithm);

}  // namespace kervan::planning
