#include "components/behavior/behaviour_shell.hpp"
#include "components/behavior/side_avoid.hpp"

namespace kervan::behavior {
namespace {

struct SideAvoidDeclaration {
  using Behaviour = SideAvoid;
  static constexpr const char* name = "side_avoid";
  static constexpr int priority = 40;
  static constexpr int hold = 0;

  template <class Visitor>
  static void describe(SideAvoidParams& p, Visitor& v) {
    v(p.distance, "distance",
      {.unit = "m", .min = 0.01, .max = 5.0, .help = "Something nearer beside it is too near.", .live = true});
    v(p.turn_rate, "turn_rate", {.unit = "rad/s", .min = 0.01, .max = 5.0, .help = "Turning rate.", .live = true});
    v(p.most_turn, "most_turn",
      {.unit = "rad",
       .min = 0.01,
       .max = 6.3,
       .help = "Turned away so far, it drives straight on until the side is free.",
       .live = true});
    v(p.speed, "speed", {.unit = "m/s", .min = 0.0, .max = 2.0, .help = "Speed meanwhile.", .live = true});
  }
};

}  // namespace
}  // namespace kervan::behavior

KERVAN_COMPONENT(kervan::behavior::BehaviourComponent<kervan::behavior::SideAvoidDeclaration>, "behavior/side_avoid",
                 "Turns away from what is too near beside the robot.")
