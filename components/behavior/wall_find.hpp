/// Looks for a wall and stops beside it.
#pragma once

#include <optional>
#include <vector>

#include "components/behavior/situation.hpp"

namespace kervan::behavior {

/// Distances are readings of the transducers. `lost`, `stop` and `sector` are the paper's 1000 mm, 400 mm and 5
/// degrees; it prints no speeds.
struct WallFindParams {
  double lost = 1.0;                       ///< m; with nothing nearer on the right it looks for a wall
  double stop = 0.4;                       ///< m before the wall
  double sector = geometry::radians(5.0);  ///< rad, between two directions of the look around
  double speed = 0.2;                      ///< m/s
  double turn_rate = 0.5;                  ///< rad/s
  double braking = 0.3;                    ///< m/s2 that it counts on before the wall
  double onwards = 2.0;  ///< m to drive before it looks around again, if nothing has been heard; then farther
};

/// Wall finding, paper's table of behaviours: a full turn, noting in each sector the nearest echo of -10..10 degrees;
/// drive towards the nearest of all; stop 400 mm before it; turn to the left until the wall is beside the robot.
///
/// A cone hears the same thing in many sectors, a region of constant depth; the thing is in the middle of them (J. J.
/// Leonard, H. F. Durrant-Whyte, Directed Sonar Sensing for Mobile Robot Navigation, 1992). Where the drive has come as
/// near as that echo was, the wall is there, whether or not it is heard from so near.
///
/// The paper turns "until the minimum over -100..-80 degrees is smallest". In cones of ±15 degrees that minimum is the
/// same over 30 degrees, so the turn ends where the readings before and behind the wheels agree. Where it was carried
/// off while looking around, by another behaviour, it begins anew. The paper does not say what to do where nothing is
/// heard: it drives on in a growing square, by quarter turns to the left, so that it comes past everything near.
class WallFind {
 public:
  using Params = WallFindParams;
  explicit WallFind(const Params& params) : params_(params) {}
  void set_params(const Params& params) { params_ = params; }

  enum class Phase { idle, look, drive, align };
  Phase phase() const { return phase_; }

  Wish step(const Situation& situation);

 private:
  /// What was ahead in one direction.
  struct Noted {
    double yaw;
    double range;
  };

  void enter(Phase phase, const Situation& situation);
  /// The nearest echo of the look around, and the direction it came from.
  std::optional<Noted> nearest() const;
  Wish look(const Situation& situation, const SonarView& view);
  Wish drive(const Situation& situation, const SonarView& view);
  Wish align(const Situation& situation, const SonarView& view);

  Params params_;
  Phase phase_ = Phase::idle;
  geometry::Vector2 entered_ = geometry::Vector2::Zero();  // where the robot was when the phase began
  TurnedAngle turned_;
  std::vector<Noted> noted_;  // of this look around
  double bearing_ = 0.0;      // yaw of the way to drive
  double way_ = 0.0;          // m to drive
  int in_vain_ = 0;           // looks since something was heard
};

}  // namespace kervan::behavior
