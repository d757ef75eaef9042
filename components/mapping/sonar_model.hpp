/// What a sonar's reading says about a place in its cone: Murphy's sensor model (R. R. Murphy, Introduction to AI
/// Robotics, 2000, chapter 11).
#pragma once

#include <numbers>

#include "components/grid/masses.hpp"

namespace kervan::mapping {

/// Which distances belong to Region I. `reading`: those within the tolerance of the reading, as Murphy has it.
/// `fixed`: those of wall following, whatever was read: 0.35 .. 0.50 m, and Region II below; a reading beyond them says
/// that Region II is empty.
enum class Regions { reading, fixed };

/// An echo came from one place of its arc, but the model gives all of it to "occupied": with the book's Max_occupied
/// the arcs stay in the map. 0.7 makes a place believed only if several readings agree on it, and within 0.57 R.
/// Symbols of the book: R is max_range, β half_aperture, Max_occupied max_occupied; r is the distance of a place from
/// the transducer, α its angle off the axis, s the reading.
struct SonarModelParams {
  double max_range = 5.0;                                  ///< m, R: a reading from here on is no echo
  double half_aperture = 15.0 * std::numbers::pi / 180.0;  ///< rad, β
  double tolerance = 0.05;                                 ///< m, half the width of the arc that an echo may come from
  double max_occupied = 0.7;                               ///< a place is never surer to be occupied; in the book 0.98
  Regions regions = Regions::reading;
  /// A formula may give less than one half for what its region stands for, far away at the edge of the cone. Taken
  /// literally that speaks for the opposite: empty space would be occupied. So it counts as saying nothing, unless
  /// asked.
  bool literal = false;
  double record_above = 0.0;  ///< Region I counts only where a single reading makes P(occupied) more than this
};

inline constexpr double fixed_near = 0.35;  ///< m, where the fixed Region I begins
inline constexpr double fixed_far = 0.50;   ///< m, where it ends

enum class Region {
  occupied,  ///< I: the echo came from about here
  empty,     ///< II: it came from farther away
  beyond,    ///< III: behind the echo
  outside,   ///< IV: not in the cone
};

/// P(s | occupied) and P(s | empty) of one reading; both 0.5 say nothing.
struct Likelihood {
  double occupied = 0.5;
  double empty = 0.5;
};

/// Distances of the two borders, m: empty below `empty_below`, occupied from there up to `occupied_to`.
struct RegionBorders {
  double empty_below = 0.0;
  double occupied_to = 0.0;
};

/// Values that are no distance (NaN, negative) have no meaning here; whoever has them leaves them out.
class SonarModel {
 public:
  explicit SonarModel(const SonarModelParams& params) : params_(params) {}

  const SonarModelParams& params() const { return params_; }

  /// Where the regions end for an echo from s.
  RegionBorders borders(double s) const;

  Region region(double r, double alpha, double s) const;

  /// ½ [(R - r)/R + (β - α)/β] · Max_occupied: P(occupied) of Region I.
  double occupied(double r, double alpha) const;

  /// ½ [(R - r)/R + (β - α)/β]: P(empty) of Region II; may reach 1.
  double empty(double r, double alpha) const;

  /// The two above where they count: 0.5 where a place of that region is told nothing.
  double counted_occupied(double r, double alpha) const;
  double counted_empty(double r, double alpha) const;

  /// What the reading s says about a place, literally (params().literal is not asked).
  Likelihood likelihood(double r, double alpha, double s) const;

  /// The same as masses of belief: what does not speak for the region's state is unknown.
  grid::Masses masses(double r, double alpha, double s) const;

 private:
  SonarModelParams params_;
};

/// Equation 15 of the paper on behaviours, Bayes' rule: P(occupied | reading) from the probability before.
double updated(double prior, const Likelihood& reading);

}  // namespace kervan::mapping
