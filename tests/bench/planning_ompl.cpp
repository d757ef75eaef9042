#include "tests/bench/planning_reference.hpp"

#ifdef KERVAN_BENCH_OMPL

#include <ompl/base/MotionValidator.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/prm/PRMstar.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <cmath>

#include "components/planning/line_walk.hpp"

namespace kervan::bench {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

geometry::Vector2 point_of(const ob::State* state) {
  const double* const values = state->as<ob::RealVectorStateSpace::StateType>()->values;
  return {values[0], values[1]};
}

/// Every cell that the line touches: OMPL's own test looks at points of it, and misses thin walls.
class ExactMotions final : public ob::MotionValidator {
 public:
  ExactMotions(const ob::SpaceInformationPtr& space, const planning::Costmap& map)
      : ob::MotionValidator(space), map_(map) {}

  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return planning::walk_line(point_of(a), point_of(b),
                               [&](int x, int y, double) { return !map_.blocked(map_.index(x, y)); });
  }
  bool checkMotion(const ob::State* a, const ob::State* b, std::pair<ob::State*, double>& last) const override {
    // RRTConnect and PRM* ask only the other way.
    last.second = 0.0;
    return checkMotion(a, b);
  }

 private:
  const planning::Costmap& map_;
};

class Ompl final : public OmplPlanner {
 public:
  explicit Ompl(bool prm) : prm_(prm) {
    ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
    ompl::RNG::setSeed(1);
  }

  std::optional<double> find(const planning::Costmap& map, Cell start, Cell goal, double limit) override {
    const auto space = std::make_shared<ob::RealVectorStateSpace>(2);
    ob::RealVectorBounds bounds(2);
    bounds.setLow(1.0);
    bounds.setHigh(0, map.columns() + 0.999);
    bounds.setHigh(1, map.rows() + 0.999);
    space->setBounds(bounds);
    const auto information = std::make_shared<ob::SpaceInformation>(space);
    information->setStateValidityChecker([&map](const ob::State* state) {
      const geometry::Vector2 at = point_of(state);
      return !map.blocked(map.index(static_cast<int>(at.x()), static_cast<int>(at.y())));
    });
    information->setMotionValidator(std::make_shared<ExactMotions>(information, map));
    information->setup();
    ob::ScopedState<> from(space), to(space);
    from[0] = start.x + 0.5;
    from[1] = start.y + 0.5;
    to[0] = goal.x + 0.5;
    to[1] = goal.y + 0.5;
    const auto problem = std::make_shared<ob::ProblemDefinition>(information);
    problem->setStartAndGoalStates(from, to);
    const ob::PlannerPtr planner = prm_ ? ob::PlannerPtr(std::make_shared<og::PRMstar>(information))
                                        : ob::PlannerPtr(std::make_shared<og::RRTConnect>(information));
    planner->setProblemDefinition(problem);
    planner->setup();
    planner->solve(limit);
    if (!problem->hasExactSolution()) return std::nullopt;
    return problem->getSolutionPath()->as<og::PathGeometric>()->length();
  }

 private:
  bool prm_;
};

}  // namespace

std::unique_ptr<OmplPlanner> ompl_planner(const std::string& name) { return std::make_unique<Ompl>(name == "PRMstar"); }

}  // namespace kervan::bench

#else

namespace kervan::bench {

std::unique_ptr<OmplPlanner> ompl_planner(const std::string&) { return nullptr; }

}  // namespace kervan::bench

#endif
