/// What a robot hears around it, as the behaviours of a wall on the right ask for it.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string>

#include "framework/geometry/pose2.hpp"

namespace kervan::behavior {

inline constexpr double nothing = std::numeric_limits<double>::infinity();

/// One transducer, in base_link, and how far from it the nearest echo is; `nothing` if there is none.
struct SonarReading {
  geometry::Pose2 transducer;
  double range = nothing;  ///< m
};

/// Sixteen transducers in ARIA's order, as the Pioneers have them: 0 looks left, 2 to 5 ahead, 7 and 8 right, 15 left.
inline constexpr std::size_t ring_size = 16;
using SonarRing = std::array<SonarReading, ring_size>;

/// Empty if these transducers stand as the behaviours expect it: sixteen of them, each looking within 5 degrees of
/// where a Pioneer's does. Else one sentence that says what does not fit.
std::string misfit(std::span<const SonarReading> readings);

/// The ring of a robot that is seen in a mirror along its x axis: what was on the left is on the right.
SonarRing mirrored(const SonarRing& ring);

/// Readings of one round, together with points that have been felt and not heard. All distances are from the
/// transducers, in m, `nothing` where there is nothing.
class SonarView {
 public:
  /// `felt` are points of base_link. Each counts as an echo of the transducers whose cone (`field_of_view`, the whole
  /// angle) it lies in, and of the one that looks nearest to it if it lies in none.
  explicit SonarView(const SonarRing& ring, std::span<const geometry::Vector2> felt = {},
                     double field_of_view = geometry::radians(30.0));

  double operator[](std::size_t i) const { return ranges_[i]; }
  /// As operator[], without what was only felt.
  double heard(std::size_t i) const { return ring_[i].range; }

  double ahead() const { return least(3, 4); }        ///< -10 .. 10 degrees
  double front() const { return least(2, 5); }        ///< -30 .. 30 degrees
  double right() const { return least(4, 7); }        ///< -100 .. 0 degrees; 8 belongs to the rear
  double rear_right() const { return least(8, 11); }  ///< -180 .. -90 degrees
  double rear() const { return least(10, 13); }       ///< behind, 150 .. 210 degrees
  double right_front() const { return ranges_[7]; }   ///< -90 degrees, before the wheels
  double right_rear() const { return ranges_[8]; }    ///< -90 degrees, behind the wheels
  double beside() const { return least(7, 8); }       ///< the wall on the right
  double left_front() const { return ranges_[0]; }    ///< 90 degrees, before the wheels
  double left_rear() const { return ranges_[15]; }    ///< 90 degrees, behind the wheels

  /// m along the robot between the two transducers that look right.
  double spacing() const { return ring_[7].transducer.x - ring_[8].transducer.x; }

  /// The least of the transducers numbered from `first` to `last`.
  double least(std::size_t first, std::size_t last) const;

 private:
  void feel(const geometry::Vector2& point, double field_of_view);

  SonarRing ring_;
  std::array<double, ring_size> ranges_;
};

}  // namespace kervan::behavior
