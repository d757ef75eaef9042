/// A ring of sonars, each a cone of rays that reports its nearest echo.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/random.hpp"
#include "sim/robot_model.hpp"
#include "sim/surroundings.hpp"

namespace kervan::sim {

/// How far the simulated sonars are from perfect, and how finely they are simulated. All imperfections may be 0.
struct SonarSettings {
  int rays = 32;          ///< in a cone, at least 1; 1 is the centre ray alone, as Stage and MobileSim have it
  double noise = 0.01;    ///< standard deviation as a share of the distance
  double drop_out = 0.0;  ///< probability that an echo is not heard, in [0, 1]
  /// rad; echoes from surfaces met at a larger angle to their normal are lost. Nothing: surfaces answer at any angle.
  std::optional<double> incidence_limit = std::nullopt;
};

class Sonars {
 public:
  /// Throws std::invalid_argument if a setting is out of its range. `ring` must be valid (require_valid).
  Sonars(const SonarRing& ring, const SonarSettings& settings);

  std::size_t size() const { return ring_.poses.size(); }
  const SonarRing& ring() const { return ring_; }

  /// What each sonar reads with the robot at `pose`, in m, into `ranges` (size() of them): the distance from the
  /// transducer to the nearest echo in [min_range, max_range], or +infinity without an echo within max_range (REP 117),
  /// which says that the cone is free that far or that nothing came back. `scan` numbers the scans of a run.
  void measure(const Surroundings& around, const Pose2& pose, const RandomSource& random, std::uint64_t scan,
               std::span<double> ranges) const;

 private:
  /// Distance to the nearest echo before noise, of the world or of another body; infinity if there is none.
  double echo(const Surroundings& around, const Vector2& origin, std::span<const Vector2> directions, double c,
              double s) const;

  SonarRing ring_;
  SonarSettings settings_;
  double min_cosine_ = 0.0;          // of the incidence angle
  std::vector<Vector2> directions_;  // of all rays in base_link, `rays` for each sonar
};

}  // namespace kervan::sim
