/// A ring of sonars, each a cone of rays that reports its nearest echo.
///
/// *Lobe.* The cone is the lobe: a flat wall at the distance d, met at the incidence a, answers from the ray nearest to
/// its normal, d / cos(max(0, |a| - half the cone)). The outermost ray stands half a share of a ray inside the cone,
/// 0.47 degrees with 32 rays in 30 degrees, so a wall that is met beyond the cone is over-read by a share of
/// about 0.0082 tan(|a| - 15 degrees): less than 0.4 % for every echo that a limit of 25 degrees lets back.
///
/// *Specular reflection.* Surfaces throw the pulse away when they are met at more than the incidence limit, and near it
/// now and then: each firing has a limit of its own, drawn evenly between the limit less `incidence_drop_off` and the
/// limit. No wall is heard that is met at more than the limit and half the cone.
///
/// *Crosstalk.* Sonars of one robot that fire together hear each other. With the probability `crosstalk` a firing sonar
/// hears one of the others, each as likely: the pulse of that one goes to its own nearest echo and from there to this
/// one. If that way is shorter than this one's own it is taken for the echo, so half of the whole way is read. Echoes
/// behind the transducer are not heard; that they may be outside its cone is what makes crosstalk a nuisance.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/random.hpp"
#include "sim/robot_model.hpp"
#include "sim/surroundings.hpp"

namespace kervan::sim {

enum class SonarFiring {
  all,        ///< all sonars in every round
  sequential  ///< in every round the next one of each array
};

/// How far the simulated sonars are from perfect, and how finely they are simulated. All imperfections may be 0.
struct SonarSettings {
  int rays = 32;          ///< in a cone, at least 1; 1 is the centre ray alone, as Stage and MobileSim have it
  double noise = 0.01;    ///< standard deviation as a share of the distance
  double drop_out = 0.0;  ///< probability that an echo is not heard, in [0, 1]
  /// rad; echoes from surfaces met at a larger angle to their normal are lost. Nothing: surfaces answer at any angle.
  std::optional<double> incidence_limit = std::nullopt;
  double incidence_drop_off = 0.0;  ///< rad below the limit in which echoes become rare; at most the limit
  double crosstalk = 0.0;           ///< probability that a sonar hears another one's pulse, in [0, 1]
  SonarFiring firing = SonarFiring::all;
};

class Sonars {
 public:
  /// Throws std::invalid_argument if a setting is out of its range. `ring` must be valid (require_valid).
  Sonars(const SonarRing& ring, const SonarSettings& settings);

  std::size_t size() const { return ring_.poses.size(); }
  const SonarRing& ring() const { return ring_; }

  /// What each sonar reads with the body at `pose`, in m, into `ranges` (size() of them): the distance from the
  /// transducer to the nearest echo in [min_range, max_range], or +infinity without an echo within max_range (REP 117),
  /// which says that the cone is free that far or that nothing came back. NaN for those that do not fire in this round.
  /// `round` numbers the rounds of a run.
  void measure(const Surroundings& around, const Pose2& pose, const RandomSource& random, std::uint64_t round,
               std::span<double> ranges);

 private:
  friend class SonarVolley;

  /// Where a pulse comes back from.
  struct Echo {
    double distance = infinity;       // m from the transducer
    Vector2 point = Vector2::Zero();  // in map
  };
  /// One round: everything that a ring needs to fire.
  struct Round {
    Surroundings around;
    Pose2 pose;
    const RandomSource* random;
    std::uint64_t number;
    std::span<double> ranges;
  };

  /// How many sonars fire in a round, and the k-th of them.
  std::size_t firing() const;
  std::uint16_t firing(std::size_t k, std::uint64_t round) const;
  /// Makes what is in echoes_ for those that fire the readings.
  void read(const Round& round) const;
  /// The nearest echo along these rays, which ended so, comes into `nearest` if it is nearer.
  void take_echo(const Round& round, std::uint16_t i, const RayFan& rays, const RayHit* hits, Echo& nearest) const;
  /// Half of the shortest way on which a pulse comes to sonar i, whose own echo is at `own`, if it hears another one.
  double disturbed(const Round& round, std::size_t i, double own) const;

  SonarRing ring_;
  SonarSettings settings_;
  double min_cosine_;                // of the incidence angle
  std::vector<Vector2> directions_;  // of all rays in the body, `rays` for each sonar
  std::vector<Echo> echoes_;         // of each sonar before noise, of the world or of another body, in this round
};

/// Rounds of several robots in one world that fire at once. Their rays go through the world together, which is quicker
/// than one ring after the other; what they read is the same.
class SonarVolley {
 public:
  static constexpr std::size_t most = 8;  // rounds

  SonarVolley() = default;
  SonarVolley(const SonarVolley&) = delete;
  SonarVolley& operator=(const SonarVolley&) = delete;

  /// As Sonars::measure, but `ranges` are read in fire(); until then nothing may move and what is given must live.
  void add(Sonars& sonars, const Surroundings& around, const Pose2& pose, const RandomSource& random,
           std::uint64_t round, std::span<double> ranges);

  /// All that have been added measure. They are at most `most`.
  void fire();

 private:
  struct Ring {
    Sonars* sonars;
    Sonars::Round round;
  };
  struct Rays;
  /// Puts the rays of a ring to those that wait.
  void aim(std::size_t ring, Rays& rays);
  /// The echoes of the rays that wait go to their sonars.
  void cast(Rays& rays);

  std::array<std::optional<Ring>, most> rings_;
  std::size_t count_ = 0;
};

}  // namespace kervan::sim
