#include "components/behavior/behaviour_shell.hpp"
#include "components/behavior/wall_find.hpp"

namespace kervan::behavior {
namespace {

struct WallFindDeclaration {
  using Behaviour = WallFind;
  static constexpr const char* name = "wall_find";
  static constexpr int priority = 10;
  static constexpr int hold = 15;

  template <class Visitor>
  static void describe(WallFindParams& p, Visitor& v) {
    v(p.lost, "lost",
      {.unit = "m",
       .min = 0.05,
       .max = 10.0,
       .help = "With nothing nearer on that side it looks for a wall.",
       .live = true});
    v(p.stop, "stop", {.unit = "m", .min = 0.05, .max = 5.0, .help = "Stops this far before the wall.", .live = true});
    v(p.sector, "sector",
      {.unit = "rad", .min = 0.01, .max = 1.0, .help = "Between two directions of the look around.", .live = true});
    v(p.speed, "speed", {.unit = "m/s", .min = 0.01, .max = 2.0, .help = "Speed towards the wall.", .live = true});
    v(p.turn_rate, "turn_rate", {.unit = "rad/s", .min = 0.01, .max = 5.0, .help = "Turning rate.", .live = true});
    v(p.braking, "braking",
      {.unit = "m/s2", .min = 0.01, .max = 10.0, .help = "Deceleration it may count on.", .live = true});
    v(p.onwards, "onwards",
      {.unit = "m",
       .min = 0.1,
       .max = 100.0,
       .help = "Way to the next look around if nothing was heard.",
       .live = true});
  }
};

}  // namespace
}  // namespace kervan::behavior

KERVAN_COMPONENT(kervan::behavior::BehaviourComponent<kervan::behavior::WallFindDeclaration>, "behavior/wall_find",
                 "Looks for a wall and stops beside it.")
