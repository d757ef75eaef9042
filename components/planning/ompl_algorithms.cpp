#include "components/planning/ompl_algorithms.hpp"

#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/ValidStateSampler.h>
#include <ompl/geometric/planners/est/BiEST.h>
#include <ompl/geometric/planners/est/EST.h>
#include <ompl/geometric/planners/informedtrees/ABITstar.h>
#include <ompl/geometric/planners/informedtrees/AITstar.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/prm/LazyPRM.h>
#include <ompl/geometric/planners/prm/LazyPRMstar.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/rrt/InformedRRTstar.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTXstatic.h>
#include <ompl/geometric/planners/rrt/RRTsharp.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/geometric/planners/rrt/SORRTstar.h>

#include <array>

namespace kervan::planning {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

/// PRM and PRM* in one thread. OMPL's own solve() looks for ways in a second one, and grows its roadmap by the clock,
/// so that no two runs are the same.
class Roadmap final : public og::PRM {
 public:
  Roadmap(const ob::SpaceInformationPtr& information, bool star) : PRM(information, star) {}

  ob::PlannerStatus solve(const ob::PlannerTerminationCondition& stop) override {
    checkValidity();
    while (const ob::State* start = pis_.nextStart()) startM_.push_back(addMilestone(si_->cloneState(start)));
    while (const ob::State* goal = pis_.nextGoal()) goalM_.push_back(addMilestone(si_->cloneState(goal)));
    if (startM_.empty()) return ob::PlannerStatus::INVALID_START;
    if (goalM_.empty()) return ob::PlannerStatus::INVALID_GOAL;
    sampler_ = si_->allocValidStateSampler();
    simpleSampler_ = si_->allocStateSampler();
    bestCost_ = opt_->infiniteCost();
    std::vector<ob::State*> bounce(longest_bounce);
    si_->allocStates(bounce);
    bool found = false;
    for (unsigned round = 0; !stop(); ++round) {
      // The roadmap grows by an eighth, by expansion every third time, as OMPL does it.
      std::size_t left = 100 + milestoneCount() / 8;
      const ob::PlannerTerminationCondition end([&] { return left-- == 0 || stop(); });
      round % 3 == 2 ? expandRoadmap(end, bounce) : growRoadmap(end, bounce.front());
      ob::PathPtr path;
      maybeConstructSolution(startM_, goalM_, path);
      if (!path) continue;
      found = true;
      ob::PlannerSolution solution(path);
      solution.setPlannerName(getName());
      pdef_->addSolutionPath(solution);
      if (!starStrategy_) break;
    }
    si_->freeStates(bounce);
    return found ? ob::PlannerStatus::EXACT_SOLUTION : ob::PlannerStatus::TIMEOUT;
  }

 private:
  static constexpr std::size_t longest_bounce = 5;
};

enum class Ends { at_the_first_way, when_told };
enum class Joins { one_way, both_ways };

struct Entry {
  const char* name;
  Ends ends;
  Joins joins;
  ob::PlannerPtr (*make)(const ob::SpaceInformationPtr&);
};

template <class Planner>
ob::PlannerPtr make(const ob::SpaceInformationPtr& information) {
  return std::make_shared<Planner>(information);
}

template <bool star>
ob::PlannerPtr make_roadmap(const ob::SpaceInformationPtr& information) {
  return std::make_shared<Roadmap>(information, star);
}

constexpr std::array<Entry, 16> entries = {{
    {"PRMstar", Ends::when_told, Joins::both_ways, make_roadmap<true>},
    {"PRM", Ends::at_the_first_way, Joins::both_ways, make_roadmap<false>},
    {"LazyPRMstar", Ends::when_told, Joins::both_ways, make<og::LazyPRMstar>},
    {"LazyPRM", Ends::at_the_first_way, Joins::both_ways, make<og::LazyPRM>},
    {"RRTConnect", Ends::at_the_first_way, Joins::both_ways, make<og::RRTConnect>},
    {"RRT", Ends::at_the_first_way, Joins::one_way, make<og::RRT>},
    {"RRTstar", Ends::when_told, Joins::one_way, make<og::RRTstar>},
    {"InformedRRTstar", Ends::when_told, Joins::one_way, make<og::InformedRRTstar>},
    {"SORRTstar", Ends::when_told, Joins::one_way, make<og::SORRTstar>},
    {"RRTsharp", Ends::when_told, Joins::both_ways, make<og::RRTsharp>},
    {"RRTXstatic", Ends::when_told, Joins::both_ways, make<og::RRTXstatic>},
    {"BITstar", Ends::when_told, Joins::both_ways, make<og::BITstar>},
    {"ABITstar", Ends::when_told, Joins::both_ways, make<og::ABITstar>},
    {"AITstar", Ends::when_told, Joins::both_ways, make<og::AITstar>},
    {"EST", Ends::at_the_first_way, Joins::one_way, make<og::EST>},
    {"BiEST", Ends::at_the_first_way, Joins::both_ways, make<og::BiEST>},
}};

const Entry& entry_of(OmplAlgorithm algorithm) { return entries.at(static_cast<std::size_t>(algorithm)); }

}  // namespace

const std::vector<std::string>& ompl_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Entry& entry : entries) all.emplace_back(entry.name);
    return all;
  }();
  return names;
}

bool may_plan_in(OmplAlgorithm algorithm, OmplSpace space) {
  return space != OmplSpace::dubins || entry_of(algorithm).joins == Joins::one_way;
}

ob::PlannerPtr make_ompl(OmplAlgorithm algorithm, const ob::SpaceInformationPtr& information) {
  return entry_of(algorithm).make(information);
}

bool repeatable(OmplAlgorithm algorithm) {
  return algorithm != OmplAlgorithm::lazy_prm && algorithm != OmplAlgorithm::lazy_prm_star;
}

bool optimizes(OmplAlgorithm algorithm) { return entry_of(algorithm).ends == Ends::when_told; }

}  // namespace kervan::planning
