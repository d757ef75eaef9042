/// A simulated robot under the behaviours, without components: the same algorithms with the same periods, and the
/// delays that the components have among each other under lockstep.
#pragma once

#include <memory>
#include <string>

#include "components/behavior/arbiter.hpp"
#include "components/behavior/bumper.hpp"
#include "components/behavior/convex_corner.hpp"
#include "components/behavior/front_avoid.hpp"
#include "components/behavior/senses.hpp"
#include "components/behavior/side_avoid.hpp"
#include "components/behavior/stall_recover.hpp"
#include "components/behavior/wall_find.hpp"
#include "components/behavior/wall_follow.hpp"
#include "components/safety/drive_guard.hpp"
#include "sim/simulation.hpp"

namespace kervan::test {

struct BehavingParams {
  behavior::Side side = behavior::Side::right;
  behavior::WallFollowParams follow = {};
};

class BehavingRobot {
 public:
  explicit BehavingRobot(const BehavingParams& params);

  /// Ten milliseconds of the only robot of the simulation.
  void step(sim::Simulation& simulation);

  const behavior::Decision& decision() const { return decision_; }
  bool always_somebody() const { return always_somebody_; }  ///< some behaviour was active at every tick

 private:
  void tick(Time now, sim::Simulation& simulation);
  template <class Behaviour>
  bool ask(Behaviour& behaviour, const char* name, int priority, int hold, const behavior::Situation& situation,
           Time now);

  behavior::Senses senses_;
  behavior::WallFind find_{{}};
  behavior::WallFollow follow_;
  behavior::ConvexCorner convex_{{}};
  behavior::SideAvoid side_{{}};
  behavior::FrontAvoid front_{{}};
  behavior::Bumper bumper_{{}};
  behavior::StallRecover stall_{{}};
  behavior::Arbiter arbiter_{std::chrono::milliseconds(50)};
  behavior::Decision decision_;
  safety::DriveGuard guard_{{}};
  bool always_somebody_ = true;
};

}  // namespace kervan::test
