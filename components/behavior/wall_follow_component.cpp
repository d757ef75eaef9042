#include "components/behavior/behaviour_shell.hpp"
#include "components/behavior/wall_follow.hpp"

namespace kervan::behavior {
namespace {

struct WallFollowDeclaration {
  using Behaviour = WallFollow;
  static constexpr const char* name = "wall_follow";
  static constexpr int priority = 20;
  static constexpr int hold = 0;

  template <class Visitor>
  static void describe(WallFollowParams& p, Visitor& v) {
    v(p.law, "law",
      {.choices = {"paper", "proportional"}, .help = "How it turns: by fixed steps, or in proportion to the error."});
    v(p.speed, "speed", {.unit = "m/s", .min = 0.01, .max = 2.0, .help = "Speed along the wall.", .live = true});
    v(p.near, "near", {.unit = "m", .min = 0.05, .max = 5.0, .help = "Inner edge of the band.", .live = true});
    v(p.far, "far", {.unit = "m", .min = 0.05, .max = 5.0, .help = "Outer edge of the band.", .live = true});
    v(p.lost, "lost", {.unit = "m", .min = 0.05, .max = 10.0, .help = "A wall farther away is none.", .live = true});
    v(p.parallel, "parallel",
      {.unit = "m",
       .min = 0.0,
       .max = 1.0,
       .help = "Law paper: it is parallel when both readings differ by no more.",
       .live = true});
    v(p.step_turn, "step_turn",
      {.unit = "rad/s", .min = 0.001, .max = 5.0, .help = "Law paper: turning rate of a step.", .live = true});
    v(p.angle_gain, "angle_gain",
      {.unit = "1/s", .min = 0.0, .max = 20.0, .help = "Turning rate per angle to the wall.", .live = true});
    v(p.distance_gain, "distance_gain",
      {.unit = "rad/s/m", .min = 0.0, .max = 20.0, .help = "Turning rate per error of the distance.", .live = true});
    v(p.turn_rate, "turn_rate",
      {.unit = "rad/s", .min = 0.01, .max = 5.0, .help = "Highest turning rate.", .live = true});
    v(p.memory, "memory",
      {.min = 0.0, .max = 60.0, .help = "How long a wall is believed that is not heard.", .live = true});
  }
};

}  // namespace
}  // namespace kervan::behavior

KERVAN_COMPONENT(kervan::behavior::BehaviourComponent<kervan::behavior::WallFollowDeclaration>, "behavior/wall_follow",
                 "Keeps a wall at a distance beside the robot.")
