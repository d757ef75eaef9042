/// VFH+ on the scans of a laser: a polar histogram of how near the obstacles around a robot are, and the free direction
/// that costs least.
///
/// I. Ulrich, J. Borenstein, "VFH+: Reliable Obstacle Avoidance for Fast Mobile Robots", ICRA 1998,
/// doi:10.1109/ROBOT.1998.677362. What differs: an echo of a laser is certain, so a sector has the distance of the
/// nearest obstacle instead of a sum of certainties; and since the robots it is made for turn on the spot, a direction
/// that the robot cannot turn into as fast as it drives is not left out: it slows down until it can.
///
/// Symbols: φ a direction, d distance from the robot's middle, R half the robot's width and the margin, γ = asin(R / d)
/// the angle by which an obstacle is enlarged, g(φ) = μ1 Δ(φ, target) + μ2 Δ(φ, heading) + μ3 Δ(φ, before) the cost.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "components/control/control_law.hpp"
#include "components/control/heading_drive.hpp"

namespace kervan::control {

inline constexpr int vfh_sectors = 144;  ///< of 2.5 degrees; sector i begins at i times that, counter-clockwise from x

struct VfhPlusParams {
  double half_width = 0.2525;   ///< m, of the robot's body: a Pioneer 3-AT
  double nose = 0.313;          ///< m, from base_link to its front
  double margin = 0.10;         ///< m, kept between the body and what it drives past
  double block_within = 1.2;    ///< m; an obstacle nearer than this blocks its directions
  double free_beyond = 1.4;     ///< m; a direction that was blocked is free again if nothing is nearer than this
  double look = 3.0;            ///< m; what is farther away is not looked at
  double remember = 1.0;        ///< m; what goes out of the laser's sight is remembered within this; 0: nothing is
  double mu1 = 5.0;             ///< μ1 > μ2 + μ3, or it does not turn to the target
  double mu2 = 2.0;             ///< μ2
  double mu3 = 2.0;             ///< μ3
  double wide = 0.7;            ///< rad; a free valley that is wider is driven through at half of this from its edge
  double stop_distance = 0.08;  ///< m, between the nose and what it stands before
  double delay = 0.2;           ///< s, from a scan to when the robot does what was made of it
  double slow_within = 0.15;    ///< m; it is slower the nearer something is beside or before it than this
  double least_share = 0.4;     ///< of the speed, right beside something
};

/// What a step saw and did, for looking at.
struct VfhPlusView {
  std::array<float, vfh_sectors> nearest{};         ///< m, obstacle by sector after enlarging; look if there is none
  std::array<std::uint8_t, vfh_sectors> blocked{};  ///< 1 blocked, 0 free
  std::optional<double> direction;                  ///< rad, chosen; none: every sector is blocked
};

class VfhPlus {
 public:
  VfhPlus(const VfhPlusParams& params, const HeadingDriveParams& drive);
  void set_params(const VfhPlusParams& params, const HeadingDriveParams& drive);

  /// The robot stands: there is no direction before, and no sector was blocked. What it remembers of obstacles stays.
  void reset();

  /// A range at or beyond range_max is free, -infinity is an obstacle at range_min (REP 117); NaN and others below
  /// range_min say nothing, and those that are NaN or negative are counted. A target that can be driven to in a
  /// straight line, whatever lies behind it, is driven to. If all is blocked it is hindered, and turns on the spot to
  /// the side where the target is, always the same until something is free. A fault is as reset(): what is not finite,
  /// or a scan that is not possible(). Allocates only when the beams of the scan are others than before.
  Steering step(const RobotState& robot, const geometry::Vector2& target, const PlacedScan& seen);

  const VfhPlusView& view() const { return view_; }
  std::uint64_t refused_ranges() const { return refused_ranges_; }

 private:
  void use_beams(const geometry::Scan& scan);
  void gather(const geometry::Vector2& robot, const PlacedScan& seen);
  void remember(const geometry::Vector2& robot, const PlacedScan& seen);
  void fill_histogram();
  std::optional<double> choose(const RobotState& robot, const geometry::Vector2& way) const;
  bool open(const geometry::Vector2& way) const;
  double limited(double speed, double yaw, double error) const;

  VfhPlusParams params_;
  HeadingDriveParams drive_;
  double keep_ = 0.0;                                 // m, R
  std::vector<std::uint8_t> spread_;                  // γ in sectors, by d
  std::vector<geometry::Vector2> beams_;              // directions in the laser's frame
  double angle_min_ = 0.0, angle_increment_ = 0.0;    // theirs
  std::vector<geometry::Vector2> points_;             // of the step at hand, from base_link, axes as those of its pose
  std::vector<geometry::Vector2> near_, remembered_;  // in the frame of the pose: of the last scan; out of sight
  std::array<float, vfh_sectors> raw_{};              // m, nearest point by sector
  VfhPlusView view_;
  std::optional<double> before_;  // rad, chosen before
  double searching_ = 0.0;        // the side to which it turns because all is blocked: 1 left, -1 right, 0 it does not
  std::uint64_t refused_ranges_ = 0;
};

}  // namespace kervan::control
