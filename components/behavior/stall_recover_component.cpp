#include "components/behavior/behaviour_shell.hpp"
#include "components/behavior/stall_recover.hpp"

namespace kervan::behavior {
namespace {

struct StallRecoverDeclaration {
  using Behaviour = StallRecover;
  static constexpr const char* name = "stall_recover";
  static constexpr int priority = 70;
  static constexpr int hold = 0;

  template <class Visitor>
  static void describe(StallRecoverParams& p, Visitor& v) {
    v(p.obstacle_distance, "obstacle_distance",
      {.unit = "m",
       .min = 0.01,
       .max = 5.0,
       .help = "Towards an obstacle nearer than this it does not drive on in the second half of an attempt.",
       .live = true});
    v(p.move_time, "move_time", {.min = 0.1, .max = 60.0, .help = "Time of one attempt.", .live = true});
    v(p.speed, "speed", {.unit = "m/s", .min = 0.01, .max = 2.0, .help = "Speed of an attempt.", .live = true});
    v(p.turn, "turn",
      {.unit = "rad", .min = 0.01, .max = 6.3, .help = "Angle to turn by in an attempt.", .live = true});
    v(p.again_within, "again_within",
      {.min = 0.0, .max = 60.0, .help = "A stall so soon after an attempt is answered by the next one.", .live = true});
  }
};

}  // namespace
}  // namespace kervan::behavior

KERVAN_COMPONENT(kervan::behavior::BehaviourComponent<kervan::behavior::StallRecoverDeclaration>,
                 "behavior/stall_recover", "Frees a robot whose wheels are stalled.")
