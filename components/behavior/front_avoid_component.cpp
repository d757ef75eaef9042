#include "components/behavior/behaviour_shell.hpp"
#include "components/behavior/front_avoid.hpp"

namespace kervan::behavior {
namespace {

struct FrontAvoidDeclaration {
  using Behaviour = FrontAvoid;
  static constexpr const char* name = "front_avoid";
  static constexpr int priority = 50;
  static constexpr int hold = 0;

  template <class Visitor>
  static void describe(FrontAvoidParams& p, Visitor& v) {
    v(p.distance, "distance",
      {.unit = "m", .min = 0.05, .max = 5.0, .help = "Something nearer ahead is too near.", .live = true});
    v(p.turn, "turn", {.unit = "rad", .min = 0.1, .max = 6.3, .help = "Angle to turn by.", .live = true});
    v(p.turn_rate, "turn_rate", {.unit = "rad/s", .min = 0.01, .max = 5.0, .help = "Turning rate.", .live = true});
  }
};

}  // namespace
}  // namespace kervan::behavior

KERVAN_COMPONENT(kervan::behavior::BehaviourComponent<kervan::behavior::FrontAvoidDeclaration>, "behavior/front_avoid",
                 "Turns away from what is ahead: the concave corner of a wall that is followed.")
