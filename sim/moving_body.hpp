/// An obstacle on its way along its script. Metres and radians, in the frame `map`.
#pragma once

#include <optional>
#include <string>

#include "sim/drive.hpp"
#include "sim/moving_obstacle.hpp"
#include "sim/surroundings.hpp"

namespace kervan::sim {

class MovingBody {
 public:
  /// `obstacle` must outlive it.
  explicit MovingBody(const MovingObstacle& obstacle);

  /// Another body that it waits for, and where it would touch that.
  struct Touch {
    std::string other;
    Vector2 point;
  };

  /// Follows its script for `dt`, as far as `around` lets it; walls are no hindrance, since doors move in them. When it
  /// would come nearer than a micrometre to a body it waits there, and goes on with the rest of the script when there
  /// is room. Returns whom it waits for.
  std::optional<Touch> move(Duration dt, const Surroundings& around);

  const MovingObstacle& obstacle() const { return *obstacle_; }
  const Pose2& pose() const { return pose_; }

 private:
  bool try_time(Duration time, const Surroundings& around);

  const MovingObstacle* obstacle_;
  double fastest_ = 0.0;  // m/s of any of its points
  Duration time_{0};      // of the script; it stands still while the obstacle waits
  Pose2 pose_;
};

}  // namespace kervan::sim
