/// Plans with planners of OMPL, by their names.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "components/planning/map_planner.hpp"

namespace kervan::planning {

/// Those of OMPL 1.5.2 that plan in one thread and need no projection of their space. In the order of ompl_names().
enum class OmplAlgorithm {
  prm_star,
  prm,
  lazy_prm_star,
  lazy_prm,
  rrt_connect,
  rrt,
  rrt_star,
  informed_rrt_star,
  sorrt_star,
  rrt_sharp,
  rrtx_static,
  bit_star,
  abit_star,
  ait_star,
  est,
  bi_est,
};

/// As OMPL calls them: "PRMstar", "RRTConnect".
const std::vector<std::string>& ompl_names();

/// How the robot moves.
enum class OmplSpace {
  plane,        ///< turns on the spot: its heading does not count
  se2,          ///< turns on the spot; as much turning as has to be counts as a way
  dubins,       ///< forwards only, no turn tighter than the turning radius
  reeds_shepp,  ///< forwards and backwards, no turn tighter than the turning radius
};

/// Dubins' curves there and back are not the same: planners that try a motion one way and use it in both are not for
/// them.
bool may_plan_in(OmplAlgorithm algorithm, OmplSpace space);

/// Same seed, same answer, if it is given a budget of steps. The lazy roadmaps keep some of their milestones in the
/// order of their addresses.
bool repeatable(OmplAlgorithm algorithm);

struct OmplParams {
  CostmapParams costs = {};  ///< only the length of a way counts, so there is no clearance
  OmplAlgorithm algorithm = OmplAlgorithm::prm_star;
  OmplSpace space = OmplSpace::plane;
  double turning_radius = 0.5;  ///< m, > 0
  bool simplify = true;         ///< ways are made shorter as long as there is time
  double deadline = 0.2;        ///< s; the budget of a query that has no most_expanded
  std::uint32_t seed = 1;       ///< > 0
};

/// Plans only exact solutions, of motions that were tested cell by cell, within its deadline, whatever the planner does
/// (OmplBudget). Query::most_expanded is the budget in steps, Plan::expanded what was spent of it. OMPL's random
/// numbers are one sequence for the whole process: planners with a budget of steps take turns.
///
/// OMPL: I. Sucan, M. Moll and L. Kavraki 2012, "The Open Motion Planning Library", doi:10.1109/MRA.2012.2205651.
class OmplPlanner final : public MapPlanner {
 public:
  explicit OmplPlanner(const OmplParams& params);

  /// Asked often while a plan is made, in the same thread; true: it ends within 10 ms, as Outcome::timeout.
  void set_cancelled(std::function<bool()> cancelled) { cancelled_ = std::move(cancelled); }

  void set_deadline(double seconds) { params_.deadline = seconds; }

  void plan(const Query& query, Plan& plan) override;

 private:
  OmplParams params_;
  std::function<bool()> cancelled_;
};

}  // namespace kervan::planning
