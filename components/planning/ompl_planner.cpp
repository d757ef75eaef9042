#include "components/planning/ompl_planner.hpp"

#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/util/Console.h>
#include <ompl/util/Exception.h>
#include <ompl/util/RandomNumbers.h>

#include <mutex>
#include <numbers>

#include "components/planning/ompl_algorithms.hpp"
#include "components/planning/ompl_space.hpp"
#include "components/planning/plan_ends.hpp"

namespace kervan::planning {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using geometry::Pose2;
using geometry::Vector2;

constexpr std::string_view out_of_time = "no route: the planner found no way in its time";
constexpr std::string_view not_wanted = "no route: the plan was cancelled";

constexpr int any_headings = 8;       // stand for all of them at the goal
constexpr double search_share = 0.9;  // of the budget of a planner that uses all of it; the rest makes the way shorter
constexpr double goal_radius = 1e-3;  // cells
constexpr int most_simplifications = 8;  // rounds; later ones gain next to nothing

/// What one query needs of OMPL. Members that use others come after them.
class Search {
 public:
  Search(const OmplParams& params, const Costmap& map, OmplBudget& budget)
      : params_(params),
        map_(map),
        budget_(budget),
        motions_(make_motions(params.space, map, params.turning_radius / map.resolution(), budget)),
        information_(make_space_information(motions_, map, budget)),
        problem_(std::make_shared<ob::ProblemDefinition>(information_)) {}

  /// The corners of a way of which every line was tested, all in cells; none if none was found in time.
  std::vector<Pose2> find(const Pose2& start, const std::vector<Pose2>& goals) {
    try {
      pose(start, goals);
      const ob::PlannerPtr planner = make_ompl(params_.algorithm, information_);
      planner->setProblemDefinition(problem_);
      planner->setup();
      if (optimizes(params_.algorithm) && params_.simplify) budget_.allow(search_share);
      planner->solve(ob::PlannerTerminationCondition([this] { return budget_.over(); }));
    } catch (const OmplBudget::Spent&) {
      // It may have found something before.
    } catch (const ompl::Exception&) {
      // So LazyPRM* ends if it loses its goal.
    }
    if (budget_.cancelled() || !problem_->hasExactSolution()) return {};
    auto& found = *problem_->getSolutionPath()->as<og::PathGeometric>();
    og::PathGeometric shorter = found;
    try {
      if (params_.simplify) simplify(shorter);
    } catch (const OmplBudget::Spent&) {
      shorter = found;
    }
    budget_.settle();
    if (budget_.cancelled()) return {};
    std::vector<Pose2> way = tested(shorter);
    return way.empty() ? tested(found) : way;
  }

 private:
  void pose(const Pose2& start, const std::vector<Pose2>& goals) {
    ob::ScopedState<> state(information_);
    motions_->place(state.get(), start);
    problem_->addStartState(state);
    const auto goal = std::make_shared<ob::GoalStates>(information_);
    for (const Pose2& one : goals) {
      motions_->place(state.get(), one);
      goal->addState(state);
    }
    goal->setThreshold(goal_radius);
    problem_->setGoal(goal);
    if (!optimizes(params_.algorithm)) return;
    const auto length = std::make_shared<ob::PathLengthOptimizationObjective>(information_);
    length->setCostToGoHeuristic(ob::goalRegionCostToGo);
    problem_->setOptimizationObjective(length);
  }

  void simplify(og::PathGeometric& path) {
    budget_.allow(1.0);
    og::PathSimplifier simplifier(information_);
    bool better = true;
    for (int i = 0; i < most_simplifications && better && !budget_.over(); ++i) {
      better = simplifier.reduceVertices(path);
      // Parts of a straight line are straight lines; those of a curve may be others.
      if (params_.space == OmplSpace::plane) better = simplifier.shortcutPath(path) || better;
    }
  }

  std::vector<Pose2> tested(og::PathGeometric& path) {
    std::vector<Pose2> way = {motions_->pose_of(path.getState(0))}, corners;
    for (std::size_t i = 1; i < path.getStateCount(); ++i) {
      corners.clear();
      if (!motions_->trace(path.getState(static_cast<unsigned>(i - 1)), path.getState(static_cast<unsigned>(i)),
                           corners) ||
          !motion_is_free(map_, way.back(), corners, budget_))
        return {};
      way.insert(way.end(), corners.begin(), corners.end());
    }
    return way;
  }

  const OmplParams& params_;
  const Costmap& map_;
  OmplBudget& budget_;
  std::shared_ptr<OmplMotions> motions_;
  ob::SpaceInformationPtr information_;
  ob::ProblemDefinitionPtr problem_;
};

std::vector<Pose2> goals_of(const Query& query, OmplSpace space, const Vector2& at) {
  if (query.goal_heading || space == OmplSpace::plane) return {{at.x(), at.y(), query.goal_heading.value_or(0.0)}};
  std::vector<Pose2> goals;
  for (int i = 0; i < any_headings; ++i) goals.push_back({at.x(), at.y(), 2.0 * std::numbers::pi * i / any_headings});
  return goals;
}

}  // namespace

OmplPlanner::OmplPlanner(const OmplParams& params) : MapPlanner(params.costs), params_(params) {
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
}

void OmplPlanner::plan(const Query& query, Plan& plan) {
  const auto ends = find_ends(map_, query, plan);
  if (!ends) return;
  // OMPL draws the seeds of all its random numbers from one place.
  static std::mutex one_at_a_time;
  std::unique_lock<std::mutex> turn(one_at_a_time, std::defer_lock);
  if (query.most_expanded > 0) {
    turn.lock();
    ompl::RNG::setSeed(params_.seed);
  }
  OmplBudget budget =
      query.most_expanded > 0 ? OmplBudget::of_steps(query.most_expanded) : OmplBudget::of_seconds(params_.deadline);
  budget.set_cancelled(cancelled_);
  const Vector2 from = ends->start.point;
  const std::vector<Pose2> way =
      Search(params_, map_, budget)
          .find({from.x(), from.y(), query.start_heading}, goals_of(query, params_.space, ends->goal.point));
  plan.expanded = budget.steps();
  if (way.empty()) return refuse(plan, Outcome::timeout, budget.cancelled() ? not_wanted : out_of_time);

  refuse(plan, Outcome::found, {});
  plan.start_moved = ends->start.moved * map_.resolution();
  plan.goal_moved = ends->goal.moved * map_.resolution();
  const auto add = [&](const Vector2& point, double heading) {
    if (!plan.points.empty()) plan.length += (point - plan.points.back()).norm();
    plan.points.push_back(point);
    if (params_.space != OmplSpace::plane) plan.headings.push_back(heading);
  };
  add(query.start, query.start_heading);
  // The ends are exactly those of the query, not what becomes of them in cells and back.
  for (std::size_t i = plan.start_moved > 0.0 ? 0 : 1; i + 1 < way.size(); ++i)
    add(map_.from_cells(way[i].position()), way[i].yaw);
  add(plan.goal_moved > 0.0 ? map_.from_cells(way.back().position()) : query.goal, way.back().yaw);
  plan.cost = plan.length;
}

}  // namespace kervan::planning
