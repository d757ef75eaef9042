/// Frees a robot whose bumper is pressed.
#pragma once

#include <optional>

#include "components/behavior/situation.hpp"

namespace kervan::behavior {

struct BumperParams {
  double speed = 0.1;      ///< m/s, as ArActionBumpers backs off
  double distance = 0.15;  ///< m, driven on after the switch is free
  Duration patience =
      std::chrono::seconds(3);  ///< for driving on; a robot that does not move is somebody else's matter
};

/// Bumper, paper's table of behaviours: contact, stop, a short move away from the switch. The paper's robot has bumpers
/// at its rear and feels them while reversing; here each contact counts whatever the robot was doing, and one at the
/// front is answered by backing off. The contact of the first moment decides on the way out; pressed at both ends, the
/// robot stands.
class Bumper {
 public:
  using Params = BumperParams;
  explicit Bumper(const Params& params) : params_(params) {}
  void set_params(const Params& params) { params_ = params; }

  Wish step(const Situation& situation);

 private:
  Params params_;
  std::optional<double> direction_;  // to drive to: 1 forward, -1 backward; nothing: nothing to do
  Time released_{};
  geometry::Vector2 from_ = geometry::Vector2::Zero();  // where the switch was released
};

}  // namespace kervan::behavior
