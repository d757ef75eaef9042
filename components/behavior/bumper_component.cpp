#include "components/behavior/behaviour_shell.hpp"
#include "components/behavior/bumper.hpp"

namespace kervan::behavior {
namespace {

struct BumperDeclaration {
  using Behaviour = Bumper;
  static constexpr const char* name = "bumper";
  static constexpr int priority = 60;
  static constexpr int hold = 0;

  template <class Visitor>
  static void describe(BumperParams& p, Visitor& v) {
    v(p.speed, "speed", {.unit = "m/s", .min = 0.01, .max = 2.0, .help = "Speed away from the switch.", .live = true});
    v(p.distance, "distance",
      {.unit = "m", .min = 0.01, .max = 5.0, .help = "Way to drive on after the switch is free.", .live = true});
    v(p.patience, "patience",
      {.min = 0.1, .max = 60.0, .help = "It gives up driving on after this time.", .live = true});
  }
};

}  // namespace
}  // namespace kervan::behavior

KERVAN_COMPONENT(kervan::behavior::BehaviourComponent<kervan::behavior::BumperDeclaration>, "behavior/bumper",
                 "Frees a robot whose bumper is pressed.")
