/// What every behaviour is given, and what every behaviour answers.
///
/// Behaviours are written for a wall on the right. For one on the left everything is mirrored along the robot's x axis
/// on the way in, and the wish on the way out.
#pragma once

#include <string_view>
#include <vector>

#include "components/behavior/sonar_view.hpp"
#include "framework/component/time.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::behavior {

/// Wheels that turn less than they are told to.
struct Stall {
  bool left = false;
  bool right = false;

  bool any() const { return left || right; }
};

/// What a robot knows of itself at one time.
struct Situation {
  Time now{};
  SonarRing ring;        ///< the last round
  geometry::Pose2 pose;  ///< of base_link in the frame of the odometry
  geometry::Twist2 speed;
  std::vector<geometry::Vector2> pressed = {};  ///< places of the bumper segments that are pressed, in base_link
  Stall stall = {};
  std::vector<geometry::Vector2> felt = {};  ///< obstacles of the last contacts, in base_link

  SonarView view() const { return SonarView(ring, felt); }
};

/// What one behaviour wants at one time.
struct Wish {
  bool active = false;     ///< false: it wants nothing, and `twist` is zero
  geometry::Twist2 twist;  ///< of base_link
  std::string_view why;    ///< a constant sentence, for people
};

inline Wish no_wish(std::string_view why) { return {false, {}, why}; }

/// The same in a mirror along the robot's x axis.
Situation mirrored(const Situation& situation);
Wish mirrored(const Wish& wish);

/// Sums the turns of a robot up, past whole turns. Positive to the left.
class TurnedAngle {
 public:
  void start(double yaw) {
    last_ = yaw;
    turned_ = 0.0;
  }
  double add(double yaw) {
    turned_ += geometry::angle_between(last_, yaw);
    last_ = yaw;
    return turned_;
  }

 private:
  double last_ = 0.0;
  double turned_ = 0.0;
};

}  // namespace kervan::behavior
