#include "components/behavior/behaviour_shell.hpp"
#include "components/behavior/convex_corner.hpp"

namespace kervan::behavior {
namespace {

struct ConvexCornerDeclaration {
  using Behaviour = ConvexCorner;
  static constexpr const char* name = "convex_corner";
  static constexpr int priority = 30;
  static constexpr int hold = 0;

  template <class Visitor>
  static void describe(ConvexCornerParams& p, Visitor& v) {
    v(p.open, "open",
      {.unit = "m", .min = 0.05, .max = 5.0, .help = "Front and side are free beyond this.", .live = true});
    v(p.found, "found",
      {.unit = "m", .min = 0.05, .max = 5.0, .help = "A wall beside it within this distance is found.", .live = true});
    v(p.ahead, "ahead",
      {.unit = "m", .min = 0.05, .max = 5.0, .help = "Something nearer ahead ends it.", .live = true});
    v(p.speed, "speed", {.unit = "m/s", .min = 0.01, .max = 2.0, .help = "Speed round the corner.", .live = true});
    v(p.radius, "radius",
      {.unit = "m", .min = 0.05, .max = 10.0, .help = "Radius of its way round the corner.", .live = true});
    v(p.give_up, "give_up",
      {.unit = "rad", .min = 0.1, .max = 6.3, .help = "Turned so far without a wall, it gives up.", .live = true});
    v(p.memory, "memory", {.min = 0.0, .max = 60.0, .help = "A wall lost within this time has ended.", .live = true});
  }
};

}  // namespace
}  // namespace kervan::behavior

KERVAN_COMPONENT(kervan::behavior::BehaviourComponent<kervan::behavior::ConvexCornerDeclaration>,
                 "behavior/convex_corner",
                 "Goes round a corner that points towards the robot, or round the end of a wall.")
