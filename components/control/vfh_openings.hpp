/// The opening finder of a paper on search and rescue robots: towards the middle of the gap that costs least.
///
/// G. Şahin, M. Balcılar, E. Uslu, S. Yavuz, M. F. Amasyalı, "Vector Field Histogram algoritmasıyla arama ve kurtarma
/// robotlarında engelden sakınma". It calls itself a Vector Field Histogram (J. Borenstein, Y. Koren, IEEE Trans.
/// Robotics and Automation 7(3), 1991, doi:10.1109/70.88137), but has neither certainties nor densities; the cost is
/// that of VFH+ (I. Ulrich, J. Borenstein, ICRA 1998, doi:10.1109/ROBOT.1998.677362) with weights of its own.
///
/// A beam is free if it sees farther than free_range; free beams side by side that span least_width are an opening; its
/// middle is a candidate. The one with the least G = a p1 + b p2 + c p3 is chosen: p1, p2 and p3 are the angles from
/// the candidate to the target, to the heading and to the direction chosen before, in degrees.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "components/control/control_law.hpp"
#include "components/control/heading_drive.hpp"

namespace kervan::control {

inline constexpr std::size_t opening_beams = 181;

/// Ranges, m, one degree apart, from the laser's right to its left: beam i looks to i - 90 degrees. Infinite: nothing
/// there; NaN: not known, and so not free.
using OpeningBeams = std::array<float, opening_beams>;

/// `scan` as if it had those beams: each has the least range of the scan's beams within half a degree of it. Returns
/// why it cannot be had; empty: it can. `scan` is possible().
std::string_view resample(const geometry::Scan& scan, OpeningBeams& beams);

struct OpeningParams {
  double free_range = 2.0;    ///< m; a beam is free if its range is more
  double least_width = 20.0;  ///< degrees between the outermost free beams of an opening
  double a = 3.0;             ///< weight of p1; only the ratios of the three matter, and their sum must be positive
  double b = 2.0;             ///< weight of p2
  double c = 3.0;             ///< weight of p3
  /// In an opening that is wide enough on both sides of the target, or of what is nearest to it, that is the candidate,
  /// instead of the middle. Not in the paper.
  bool clip = false;
};

/// Directions in degrees from beam 0, as the paper counts: 90 is straight ahead of the laser. They may be any angle.
struct OpeningDirections {
  double target = 90.0;
  double heading = 90.0;
  std::optional<double> before = {};  ///< the direction chosen before; none yet: p3 is 0
};

/// The direction of the candidate that costs least, of equal ones the lower; none if there is no opening. The weights
/// are divided by their sum, so that 1, 1, 1 and 2, 2, 2 are one to the last bit.
std::optional<double> best_opening(const OpeningParams& params, const OpeningBeams& beams,
                                   const OpeningDirections& directions);

/// Drives a robot step by step; it remembers the direction chosen before, in the frame of the robot's pose.
class VfhOpenings {
 public:
  VfhOpenings(const OpeningParams& openings, const HeadingDriveParams& drive) : openings_(openings), drive_(drive) {}
  void set_params(const OpeningParams& openings, const HeadingDriveParams& drive) {
    openings_ = openings;
    drive_ = drive;
  }

  /// The robot stands: there is no direction before, and none to which it searches.
  void reset() {
    before_.reset();
    searching_ = 0.0;
  }

  /// Without an opening, of which the paper says nothing, it is hindered: it turns on the spot, to the side where the
  /// target is, and goes on turning to that side until it sees one. A fault is as reset(): what is not finite, or a
  /// scan that is not possible(), does not cover 180 degrees ahead or leaves out degrees.
  Steering step(const RobotState& robot, const geometry::Vector2& target, const PlacedScan& seen);

 private:
  OpeningParams openings_;
  HeadingDriveParams drive_;
  std::optional<double> before_;  ///< rad
  double searching_ = 0.0;  ///< the side to which it turns for want of an opening: 1 left, -1 right, 0 it does not
};

}  // namespace kervan::control
